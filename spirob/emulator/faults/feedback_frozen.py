"""A drive that repeats one frame for ever."""

from spirob.can_protocol import Feedback
from spirob.emulator.faults import Course, Fault


class FeedbackFrozen(Fault):
    """Its measuring has crashed, its sending has not."""

    def sensed(self, motor: int, said: Feedback, course: Course) -> Feedback:
        """The first frame of the fault."""
        return course.kept.setdefault(motor, said)
