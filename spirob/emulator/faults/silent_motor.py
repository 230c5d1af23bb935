"""A drive that says nothing any more."""

from spirob.can_protocol import CanFrame
from spirob.emulator.faults import Course, Fault


class SilentMotor(Fault):
    """A torn feedback wire, a crashed firmware: it still drives, but nobody knows how."""

    def on_bus(self, frame: CanFrame, course: Course) -> list[CanFrame]:
        """Nothing."""
        return []
