"""The way between drives and controller with everything that goes wrong on it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from numpy.random import Generator

from spirob.can_protocol import FEEDBACK_ID, CanFrame, Feedback
from spirob.emulator.faults.fault import Course, Fault


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
