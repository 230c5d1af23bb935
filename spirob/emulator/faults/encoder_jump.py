"""An encoder whose angle jumps and stays off."""

from dataclasses import replace

from spirob.can_protocol import COUNTS_PER_TURN, Feedback
from spirob.emulator.faults import Course, Fault
from spirob.parameter import bounded


class EncoderJump(Fault):
    """A slipping magnet, a lost index."""

    jump: float = bounded(2048.0, -4095.0, 4095.0, "count", "j", "by how much")

    def sensed(self, motor: int, said: Feedback, course: Course) -> Feedback:
        """The angle after the jump."""
        return replace(said, angle=(said.angle + round(self.jump)) % COUNTS_PER_TURN)
