"""The signals that a composed law may read, along all trials, and the sizes in which they count."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from spirob.machine.composed import memory
from spirob.machine.inverse import InverseProblem

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
    """

    middle: float
    half: float
    fast: float
    heavy: float
    long: float
    rest_speed: float
    turn: float

    def taught(self) -> dict[str, tuple[float, float]]:
        """Argument -> lowest and highest value."""
        return {
            "place": (self.middle - self.half, self.middle + self.half),
            "speed": (-self.fast, self.fast),
            "rest_speed": (0.5 * self.rest_speed, 2.0 * self.rest_speed),
            "load": (-self.heavy, self.heavy),
            "time": (0.0, self.long),
        }


class Track:
    """All samples of all pieces of one role in a row, (n,)."""

    def __init__(self, problem: InverseProblem, changes: Mapping[str, float]):
        self.problem, self.changes = problem, dict(changes)
        asked = problem.asked
        vector = problem.table.vector(problem.completed(changes))
        motion = asked.seen(vector)
        self.signals = {"place": motion.q, "speed": motion.v, "time": motion.seconds}
        self.signals["load"] = asked.load(motion, vector)
        self.starts, self.steps = motion.starts, motion.steps
        self.placed = problem.rig.position is not None

    def ranges(self) -> Ranges:
        """Of this motion, of what is compared of it."""
        used = {
            name: self.problem.thinned(values) for name, values in self.signals.items()
        }
        place, turns = used["place"], self.problem.sizes.axis_unit == "rad"
        low, high = float(place.min()), float(place.max())
        return Ranges(
            0.5 * (low + high),
            max(0.5 * (high - low), 1e-9),
            float(np.abs(used["speed"]).max()) or 1.0,
            float(np.abs(used["load"]).max()) or 1.0,
            float(used["time"].max()) or 1.0,
            self.problem.rest_speed,
            2 * np.pi if turns else 0.0,
        )

    def values(self, ranges: Ranges) -> dict[str, np.ndarray | float | Callable[..., np.ndarray]]:
        """What the text of a shape may name, each (n,) or a number."""
        known = {**FUNCTIONS, **self.signals, **vars(ranges)}
        for name, text in SHORT.items():
            known[name] = eval(text, {"__builtins__": {}}, known)  # of this file, never of another
        return known

    def remembered(
        self, kind: str, followed: np.ndarray, reach: float
    ) -> np.ndarray:
        """A memory along the motion, (n,), begun anew in each piece."""
        return memory.along(kind, followed, reach, self.starts, self.steps)

    def column(self, values: np.ndarray) -> np.ndarray:
        """What a braking torque (n,) makes of the residual, (N,)."""
        return self.problem.shown(-np.asarray(values, float), self.changes)
