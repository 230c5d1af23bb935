"""The signals that a composed law may read, and memories that follow them.

Signals run along all trials, in the sizes in which they count.  Memories are bristles that turn
round over a way, what follows a signal slowly, and the time since the motion turned; each is
advanced exactly over a step, along a motion here and, in the same words, in a written law.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from types import CodeType
from typing import Any

import numpy as np
from numba import njit

from spirob.machine.inverse.problem import InverseProblem
from spirob.ports import SIGNALS as PORT_SIGNALS

LONG = 1e3  # s since a turn that never was


@dataclass(frozen=True)
class Memory:
    """One kind of memory.

    begin      states, and what they begin with
    evolution  rate of change of each, in the same names, where they follow one
    numbers    name in these texts -> key in `NUMBERS`
    lines      that advance the states over `dt` in a kernel
    run        the same along a signal: of states (states, n), signal (n,), numbers, pieces, steps
    """

    begin: dict[str, float]
    numbers: dict[str, str]
    lines: tuple[str, ...]
    evolution: tuple[str, ...]
    run: Callable[..., None]


@njit(cache=True)
def _bristle(out, followed, numbers, starts, steps):
    reach = numbers[0]
    for piece in range(len(starts) - 1):
        state = 0.0
        for k in range(starts[piece], starts[piece + 1]):
            end = 1.0 if followed[k] > 0.0 else -1.0
            state = end + (state - end) * np.exp(-abs(followed[k]) * steps[piece] / reach)
            out[0, k] = state


@njit(cache=True)
def _spring(out, followed, numbers, starts, steps):
    reach = numbers[0]
    for piece in range(len(starts) - 1):
        state = 0.0
        for k in range(starts[piece], starts[piece + 1]):
            end = 1.0 if followed[k] > 0.0 else -1.0
            path = abs(followed[k]) * steps[piece] / reach
            free = max(0.0, min(path, -end * state))
            bent = np.tanh(path - free)
            ahead = end * state + free
            state = end * (ahead if path <= free else (ahead + bent) / (1.0 + ahead * bent))
            out[0, k] = state


@njit(cache=True)
def _slow(out, followed, numbers, starts, steps):
    reach = numbers[0]
    for piece in range(len(starts) - 1):
        state = 0.0
        for k in range(starts[piece], starts[piece + 1]):
            state = followed[k] + (state - followed[k]) * np.exp(-steps[piece] / reach)
            out[0, k] = state


@njit(cache=True)
def _turn(out, followed, numbers, starts, steps):
    for piece in range(len(starts) - 1):
        since, side = LONG, 0.0
        for k in range(starts[piece], starts[piece + 1]):
            now = side
            if abs(followed[k]) > 1.0:
                now = 1.0 if followed[k] > 0.0 else -1.0
            since = 0.0 if now * side < 0.0 else since + steps[piece]
            side = now
            out[0, k], out[1, k] = since, side


MEMORIES = {
    # Dahl: the way back is bent as the way there
    "bristle": Memory(
        {"bend": 0.0},
        {"reach": "r"},
        (
            "end = 1.0 if speed > 0.0 else -1.0",
            "bend = end + (bend - end) * exp(-Abs(speed) * dt / {reach})",
        ),
        ("(speed - Abs(speed)*bend)/{reach}",),
        _bristle,
    ),
    # Bouc and Wen: springs back straight, then yields
    "spring": Memory(
        {"bend": 0.0},
        {"reach": "r"},
        (
            "end = 1.0 if speed > 0.0 else -1.0",
            "path = Abs(speed) * dt / {reach}",
            "free = Max(0.0, Min(path, -end * bend))",
            "bent = tanh(path - free)",
            "ahead = end * bend + free",
            "bend = end * (ahead if path <= free else (ahead + bent) / (1.0 + ahead * bent))",
        ),
        ("speed*(1.0 - bend**2*(0.5 + 0.5*sign(speed*bend)))/{reach}",),
        _spring,
    ),
    "slow": Memory(
        {"slow": 0.0},
        {"reach": "e"},
        ("slow = ({followed}) + (slow - ({followed})) * exp(-dt / {reach})",),
        ("(({followed}) - slow)/{reach}",),
        _slow,
    ),
    # a motion turns where it is as fast as what counts as standing
    "turn": Memory(
        {"since": LONG, "side": 0.0},
        {},
        (
            "moving = 1.0 if speed > 0.0 else -1.0",
            "now = moving if Abs(speed) > rest_speed else side",
            "since = 0.0 if now * side < 0.0 else since + dt",
            "side = now",
        ),
        (),
        _turn,
    ),
}


def along(
    kind: str,
    followed: np.ndarray,
    numbers: Sequence[float],
    starts: np.ndarray,
    steps: np.ndarray,
) -> np.ndarray:
    """The states after each sample, (states, n); `followed` is the speed of a bristle."""
    memory = MEMORIES[kind]
    out = np.empty((len(memory.begin), len(followed)))
    values = np.array(numbers, float)
    memory.run(out, np.ascontiguousarray(followed, float), values, starts, steps)
    return out


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
    "drive": "gives*current/strong",
    "strength": "Abs(current)/strong",
    "working": "tanh(speed/rest_speed)*tanh(1e3*current/strong)",
}
SIGNALS = {  # argument -> name in `spirob.ports.SIGNALS`
    "place": "winch.displacement",
    "speed": "motor.speed",
    "rest_speed": "motor.rest_speed",
    "load": "motor.load_torque",
    "time": "time",
    "current": "motor.current",
}


@dataclass(frozen=True)
class Ranges:
    """The motion that teaches a law: in these sizes its signals count.

    middle, half  of the way;  fast  the highest speed;  heavy  the largest load;  long  the longest
    trial [s];  turn  after which the axis comes round, 0 where it does not
    position  name of the signal that is the place;  gear  way of the axis at the speed [rad] for
              one unit of the place;  strong  the largest effort, 0 where no drive makes it
    gives     torque of an effort of 1
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
    strong: float = 0.0
    gives: float = 1.0

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
            "current": (-self.strong, self.strong),
        }


def evaluated(text: str, known: Mapping[str, Any]) -> Any:
    """The value of a text of this package, never of another."""
    return eval(_compiled(text), {"__builtins__": {}}, known)


@cache  # a term's numbers have names: its text is one whatever they are
def _compiled(text: str) -> CodeType:
    return compile(text, "<law>", "eval")


@dataclass(frozen=True)
class Track:
    """All samples of all pieces of one role in a row.

    signals  argument -> (n,), `current` of a drive alone
    starts   (pieces + 1,) where memory begins anew;  steps  (pieces,) sample periods [s]
    placed   whether the log has a position
    """

    signals: dict[str, np.ndarray]
    starts: np.ndarray
    steps: np.ndarray
    placed: bool = True
    _known: dict[Ranges, dict[str, Any]] = field(default_factory=dict, repr=False, compare=False)

    @classmethod
    def of(cls, problem: InverseProblem, changes: Mapping[str, float]) -> "Track":
        """The motion of a problem's trials, as the model with these numbers sees it."""
        vector = problem.table.vector(problem.completed(changes))
        motion = problem.asked.seen(vector)
        signals = {"place": motion.q, "speed": motion.v, "time": motion.seconds}
        signals["load"] = load = problem.asked.load(motion, vector)
        if problem.rig.effort.origin != "sensor":
            read = problem.asked.signals(motion, load, vector)
            signals["current"] = problem.asked.made(vector, motion, read)
        return cls(signals, motion.starts, motion.steps, problem.rig.position is not None)

    def values(self, ranges: Ranges) -> dict[str, Any]:
        """What the text of a shape may name, each (n,) or a number."""
        if ranges not in self._known:
            known: dict[str, Any] = {**FUNCTIONS, **self.signals, **vars(ranges)}
            for name, text in SHORT.items():
                if "current" in self.signals or "current" not in text:
                    known[name] = evaluated(text, known)
            self._known[ranges] = known
        return self._known[ranges]

    def remembered(
        self, kind: str, followed: np.ndarray, numbers: Sequence[float]
    ) -> dict[str, np.ndarray]:
        """The states of a memory along the motion, (n,) each, begun anew in each piece."""
        found = along(kind, followed, numbers, self.starts, self.steps)
        return dict(zip(MEMORIES[kind].begin, found, strict=True))


def ranges_of(
    used: Mapping[str, np.ndarray], rest_speed: float, turn: float, gives: float = 1.0
) -> Ranges:
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
        strong=float(np.abs(used["current"]).max()) if "current" in used else 0.0,
        gives=gives,
    )
