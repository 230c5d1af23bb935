"""Frames that never arrive; with a probability of 1 a burst of them."""

from spirob.can_protocol import CanFrame
from spirob.emulator.faults import Course, Fault
from spirob.parameter import bounded


class Lost(Fault):
    """A weak plug, a full buffer."""

    probability: float = bounded(0.01, 0.0, 1.0, "1", "p", "of each frame")

    def on_bus(self, frame: CanFrame, course: Course) -> list[CanFrame]:
        """Nothing, now and then."""
        return [] if course.happens(self.probability) else [frame]
