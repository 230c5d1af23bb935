"""An encoder whose zero lies elsewhere, so that its angle wraps at other moments."""

from dataclasses import replace

from spirob.can_protocol import COUNTS_PER_TURN, Feedback
from spirob.emulator.faults import Course, Fault
from spirob.parameter import bounded


class EncoderWrap(Fault):
    """No fault of the drive, but of whoever forgets the wrap."""

    offset: float = bounded(4096.0, 0.0, 8191.0, "count", "o", "of the angle")

    def sensed(self, motor: int, said: Feedback, course: Course) -> Feedback:
        """The angle from another zero."""
        return replace(said, angle=(said.angle + round(self.offset)) % COUNTS_PER_TURN)
