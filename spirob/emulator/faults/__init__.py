"""What goes wrong between the drives and the controller; one file each.

A file here defines one class of `Fault`; the file's name is its kind.  A configuration lists them:

    faults:
      - {kind: lost, motor: left, start: 0.5, duration: 2.0, probability: 0.1}
      - {kind: late, frames: command, delay: 0.004}

motor   left, right or both (default);  frames  feedback (default), command or both, for faults of
the bus;  start, duration [s] and all else are numbers of the kind.

A fault can change frames on the bus, a drive's readings, its supply: `Fault` is the contract of a
kind; `Wire` is the way between drives and controller with all of them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib import import_module
from pkgutil import iter_modules
from typing import Any, ClassVar

from numpy.random import Generator

from spirob.can_protocol import FEEDBACK_ID, CanFrame, Feedback
from spirob.errors import ConfigError
from spirob.parameter import Numbers, bounded
from spirob.robot import CYCLE_NS, MOTORS


@dataclass
class Course:
    """How one fault goes in one trial.

    rng     its own, decided by seed and trial
    now_ns  start of this cycle;  active  whether the fault is on in this cycle
    held    frames on their way: when they arrive, whether after the newer ones, which
    kept    what a fault remembers of each motor
    """

    rng: Generator
    now_ns: int = 0
    active: bool = False
    held: list[tuple[int, bool, CanFrame]] = field(default_factory=list)
    kept: dict[int, Feedback] = field(default_factory=dict)

    def hold(self, frame: CanFrame, cycles: int, after: bool = False) -> None:
        """Let a frame arrive some cycles later, before the newer ones or after them."""
        self.held.append((self.now_ns + cycles * CYCLE_NS, after, frame))

    def happens(self, probability: float) -> bool:
        """Whether it happens this time."""
        return bool(self.rng.random() < probability)


class Fault(Numbers):
    """One thing that goes wrong; subclasses override one of the methods below."""

    owner = "fault"
    frames: ClassVar[str] = "feedback"  # which ones, where a configuration does not say

    start: float = bounded(0.0, 0.0, 86400.0, "s", "t_0", "since the trial began")
    duration: float = bounded(86400.0, 0.001, 86400.0, "s", "T", "of the fault")

    def on_bus(self, frame: CanFrame, course: Course) -> list[CanFrame]:
        """What arrives at once when this frame is sent while the fault is on."""
        return [frame]

    def sensed(self, motor: int, said: Feedback, course: Course) -> Feedback:
        """What a drive reports instead of what it should, while the fault is on."""
        return said

    def supply(self, volts: float, course: Course) -> float:
        """The supply voltage [V] of the drives, while the fault is on."""
        return volts

    def during(self, now_ns: int) -> bool:
        """Whether the fault is on."""
        return self.start <= now_ns * 1e-9 < self.start + self.duration

    def passed(self, frames: Sequence[CanFrame], course: Course) -> list[CanFrame]:
        """What arrives in this cycle; a frame that comes late is stamped when it comes."""
        due = [entry for entry in course.held if entry[0] <= course.now_ns]
        course.held = [entry for entry in course.held if entry[0] > course.now_ns]
        late = [(after, replace(frame, stamp_ns=when + CYCLE_NS)) for when, after, frame in due]
        fresh = [
            f for sent in frames for f in (self.on_bus(sent, course) if course.active else [sent])
        ]
        return [f for after, f in late if not after] + fresh + [f for after, f in late if after]


@dataclass(frozen=True)
class Placed:
    """A fault, the motors it concerns and the directions of the bus it acts on."""

    fault: Fault
    motors: frozenset[int]
    directions: tuple[str, ...]


class Wire:
    """Several faults in the order in which they are listed; without any it changes nothing."""

    def __init__(self, placed: Sequence[Placed] = ()):
        self._placed = list(placed)
        self.feedback_id = FEEDBACK_ID  # before that of the first drive
        self._courses: list[dict[str, Course]] = []

    def __bool__(self) -> bool:
        return bool(self._placed)

    def begin(self, generator: Callable[[str], Generator]) -> None:
        """A new trial; `generator` makes a source of chance from a name."""
        self._courses = [
            {way: Course(generator(f"fault {k} {way}")) for way in ("feedback", "command", "drive")}
            for k in range(len(self._placed))
        ]

    def cycle(self, now_ns: int) -> None:
        """Which faults are on in the cycle that starts now."""
        for placed, courses in zip(self._placed, self._courses, strict=True):
            for course in courses.values():
                course.now_ns, course.active = now_ns, placed.fault.during(now_ns)

    def commands(self, frames: Sequence[CanFrame]) -> list[CanFrame]:
        """The commands that reach the drives in this cycle."""
        out = list(frames)
        for placed, courses in zip(self._placed, self._courses, strict=True):
            if "command" in placed.directions:
                out = placed.fault.passed(out, courses["command"])
        return out

    def feedback(self, frames: Sequence[CanFrame]) -> list[CanFrame]:
        """The feedback that reaches the controller in this cycle."""
        out = list(frames)
        for placed, courses in zip(self._placed, self._courses, strict=True):
            if "feedback" in placed.directions:
                first = self.feedback_id + 1
                mine = [f for f in out if f.arbitration_id - first in placed.motors]
                others = [f for f in out if f.arbitration_id - first not in placed.motors]
                out = others + placed.fault.passed(mine, courses["feedback"])
        return sorted(out, key=lambda frame: frame.stamp_ns)

    def sensed(self, motor: int, said: Feedback) -> Feedback:
        """What a drive reports."""
        for placed, courses in zip(self._placed, self._courses, strict=True):
            if motor in placed.motors and courses["drive"].active:
                said = placed.fault.sensed(motor, said, courses["drive"])
        return said

    def supply(self, volts: float) -> float:
        """The supply voltage of the drives [V]."""
        for placed, courses in zip(self._placed, self._courses, strict=True):
            if courses["drive"].active:
                volts = placed.fault.supply(volts, courses["drive"])
        return volts


DIRECTIONS = {"feedback": ("feedback",), "command": ("command",), "both": ("feedback", "command")}


def kinds() -> list[str]:
    """Names of all faults."""
    return sorted(found.name for found in iter_modules(__path__))


def load(kind: object) -> type[Fault]:
    """The class of one kind; raises ConfigError with the known ones."""
    if kind not in kinds():
        raise ConfigError(f"no fault '{kind}'; known: {', '.join(kinds())}")
    module = import_module(f"{__name__}.{kind}")
    found = [
        value
        for value in vars(module).values()
        if isinstance(value, type) and issubclass(value, Fault) and value is not Fault
    ]
    assert len(found) == 1, f"{kind} defines {len(found)} faults"
    return found[0]


def wire_from(plain: Sequence[Mapping[str, Any]]) -> Wire:
    """The wire with the faults that a configuration lists.

    Raises ConfigError naming the fault's place in the list and the key.
    """
    return Wire([_placed(given, f"robot.faults[{k}]") for k, given in enumerate(plain)])


def _placed(given: Mapping[str, Any], where: str) -> Placed:
    numbers = {k: v for k, v in given.items() if k not in ("kind", "motor", "frames")}
    kind = load(given.get("kind"))
    motor = given.get("motor", "both")
    frames = given.get("frames", kind.frames)
    if motor not in (*MOTORS, "both"):
        raise ConfigError(f"{where}: motor must be {', '.join(MOTORS)} or both, not {motor!r}")
    if frames not in DIRECTIONS:
        raise ConfigError(f"{where}: frames must be {', '.join(DIRECTIONS)}, not {frames!r}")
    for key, value in numbers.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ConfigError(f"{where}: {key} must be a number, not {value!r}")
    try:
        fault = kind.from_mapping(numbers)
    except ConfigError as error:
        raise ConfigError(f"{where}: {error}") from None
    assert isinstance(fault, Fault)
    motors = frozenset(m for m, name in enumerate(MOTORS) if motor in (name, "both"))
    return Placed(fault, motors, DIRECTIONS[frames])
