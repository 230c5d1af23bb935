"""Frames that arrive some cycles late, in their order."""

from spirob.can_protocol import CanFrame
from spirob.emulator.faults import Course, Fault
from spirob.parameter import bounded


class Late(Fault):
    """A busy adapter: frames queue up and come when it finds the time."""

    delay: float = bounded(0.003, 0.001, 1.0, "s", "d", "of every frame, in whole cycles")

    def on_bus(self, frame: CanFrame, course: Course) -> list[CanFrame]:
        """Nothing now."""
        course.hold(frame, round(self.delay * 1e3))
        return []
