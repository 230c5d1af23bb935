"""The signals that a composed law may read, along all trials, and the sizes in which they count."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from spirob.machine.composed import memory
from spirob.machine.inverse import InverseProblem
from spirob.ports import SIGNALS as PORT_SIGNALS

FUNCTIONS = {
    "Abs": np.abs,
    "Max": np.maximum,
    "Min": np.minimum,
    "sign": np.sign,
    "exp": np.exp,
    "cos": np.cos,
    "sin": np.sin,
    "tanh": np.tanh,
    "pi": np.pi,
}
SHORT = {  # what stands for a signal in a law, and what it is in the arguments of a kernel
    "away": "(place - middle)/half",
    "far": "Max(-1.0, Min(1.0, (place - middle)/half))",
    "way": "tanh(speed/rest_speed)",
    "line": "speed/fast",
    "share": "Abs(speed)/fast",
    "pull": "load/heavy",
    "late": "time/long",
}
SIGNALS = {  # argument -> name in `spirob.ports.SIGNALS`
    "place": "winch.displacement",
    "speed": "motor.speed",
    "rest_speed": "motor.rest_speed",
    "load": "motor.load_torque",
    "time": "time",
}


@dataclass(frozen=True)
class Ranges:
    """The motion that teaches a law: in these sizes its signals count.

    middle, half  of the way;  fast  the highest speed;  heavy  the largest load;  long  the longest
    trial [s];  turn  after which the axis comes round, 0 where it does not
    position  name of the signal that is the place;  gear  way of the axis at the speed [rad] for
              one unit of the place
    """

    middle: float
    half: float
    fast: float
    heavy: float
    long: float
    rest_speed: float
    turn: float
    position: str = "winch.displacement"
    gear: float = 1.0

    @property
    def unit(self) -> str:
        """Of the place."""
        return PORT_SIGNALS[self.position].unit

    def taught(self) -> dict[str, tuple[float, float]]:
        """Argument -> lowest and highest value."""
        return {
            "place": (self.middle - self.half, self.middle + self.half),
            "speed": (-self.fast, self.fast),
            "rest_speed": (0.5 * self.rest_speed, 2.0 * self.rest_speed),
            "load": (-self.heavy, self.heavy),
            "time": (0.0, self.long),
        }


@dataclass(frozen=True)
class Track:
    """All samples of all pieces of one role in a row.

    signals  argument -> (n,);  starts  (pieces + 1,) where memory begins anew
    steps    (pieces,) sample periods [s];  placed  whether the log has a position
    """

    signals: dict[str, np.ndarray]
    starts: np.ndarray
    steps: np.ndarray
    placed: bool = True

    @classmethod
    def of(cls, problem: InverseProblem, changes: Mapping[str, float]) -> "Track":
        """The motion of a problem's trials, as the model with these numbers sees it."""
        vector = problem.table.vector(problem.completed(changes))
        motion = problem.asked.seen(vector)
        signals = {"place": motion.q, "speed": motion.v, "time": motion.seconds}
        signals["load"] = problem.asked.load(motion, vector)
        return cls(signals, motion.starts, motion.steps, problem.rig.position is not None)

    def values(self, ranges: Ranges) -> dict[str, Any]:
        """What the text of a shape may name, each (n,) or a number."""
        known: dict[str, Any] = {**FUNCTIONS, **self.signals, **vars(ranges)}
        for name, text in SHORT.items():
            known[name] = eval(text, {"__builtins__": {}}, known)  # of this file, never of another
        return known

    def remembered(self, kind: str, followed: np.ndarray, reach: float) -> np.ndarray:
        """A memory along the motion, (n,), begun anew in each piece."""
        return memory.along(kind, followed, reach, self.starts, self.steps)


def ranges_of(used: Mapping[str, np.ndarray], rest_speed: float, turn: float) -> Ranges:
    """The ranges of the samples that are compared; `used` are their signals by name."""
    low, high = float(used["place"].min()), float(used["place"].max())
    return Ranges(
        0.5 * (low + high),
        max(0.5 * (high - low), 1e-9),
        float(np.abs(used["speed"]).max()) or 1.0,
        float(np.abs(used["load"]).max()) or 1.0,
        float(used["time"].max()) or 1.0,
        rest_speed,
        turn,
    )
