"""A supply that breaks down for a while."""

from spirob.emulator.faults import Course, Fault
from spirob.parameter import bounded


class PowerDip(Fault):
    """The drives stay awake on their logic supply, but have no voltage to drive with."""

    volts: float = bounded(0.0, 0.0, 24.0, "V", "U", "that are left")

    def supply(self, volts: float, course: Course) -> float:
        """What is left."""
        return min(volts, self.volts)
