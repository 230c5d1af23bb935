"""An encoder that reports one angle for ever; speed and current go on."""

from dataclasses import replace

from spirob.can_protocol import Feedback
from spirob.emulator.faults import Course, Fault


class EncoderStuck(Fault):
    """A magnet come loose."""

    def sensed(self, motor: int, said: Feedback, course: Course) -> Feedback:
        """The first angle of the fault."""
        return replace(said, angle=course.kept.setdefault(motor, said).angle)
