"""Frames that arrive twice."""

from spirob.can_protocol import CanFrame
from spirob.emulator.faults import Course, Fault
from spirob.parameter import bounded


class Duplicated(Fault):
    """An acknowledge that was lost: the sender repeats itself."""

    probability: float = bounded(0.1, 0.0, 1.0, "1", "p", "of each frame")

    def on_bus(self, frame: CanFrame, course: Course) -> list[CanFrame]:
        """The frame, now and then once more."""
        return [frame, frame] if course.happens(self.probability) else [frame]
