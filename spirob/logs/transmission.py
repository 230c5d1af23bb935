"""Counts of a drive to SI at the tendon: the one place where units of a log change."""

from math import pi

from spirob.can_protocol import COUNTS_PER_TURN
from spirob.parameter import Numbers, bounded

HALF_TURN = COUNTS_PER_TURN // 2


class Transmission(Numbers):
    """Nominal gearbox and winch between a drive's rotor and its tendon.

    x = r·θ/G [m] wound in, positive with positive rotor angle;  v = r·ω/G [m/s].
    """

    owner = "transmission"

    gear_ratio: float = bounded(3591 / 187, 0.01, 1e3, "1", "G", "rotor turns a winch turn")
    winch_radius: float = bounded(0.020, 1e-4, 1.0, "m", "r", "radius of the bare winch")

    @property
    def metre_per_count(self) -> float:
        """Tendon length a count of rotor angle [m]."""
        return 2 * pi / COUNTS_PER_TURN * self.winch_radius / self.gear_ratio

    @property
    def metre_per_second_per_rpm(self) -> float:
        """Tendon speed a revolution per minute of the rotor [m/s]."""
        return 2 * pi / 60 * self.winch_radius / self.gear_ratio
