"""Frames that are overtaken by the next one."""

from spirob.can_protocol import CanFrame
from spirob.emulator.faults import Course, Fault
from spirob.parameter import bounded


class OutOfOrder(Fault):
    """Two queues in an adapter: now and then the older frame comes after the newer."""

    probability: float = bounded(0.1, 0.0, 1.0, "1", "p", "of each frame")

    def on_bus(self, frame: CanFrame, course: Course) -> list[CanFrame]:
        """Nothing now and then; it follows the next cycle's."""
        if not course.happens(self.probability):
            return [frame]
        course.hold(frame, 1, after=True)
        return []
