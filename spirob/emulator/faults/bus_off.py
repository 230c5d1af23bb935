"""A bus on which nothing passes, in neither direction."""

from spirob.can_protocol import CanFrame
from spirob.emulator.faults import Course, Fault


class BusOff(Fault):
    """Too many errors: the controller has left the bus; the drives stop on their own time-out."""

    frames = "both"

    def on_bus(self, frame: CanFrame, course: Course) -> list[CanFrame]:
        """Nothing."""
        return []
