"""Grease that resists one way more than the other: a lip seal, or a helical gear that pumps.

Typical 18 µN·m·s more in one direction (0.6 mN·m at 40 rad/s), one tenth to a third of that in
the other; the grease shears thin over 80-200 rad/s.  The motors are mounted as mirror images, so
the direction that is harder winds in on one side and pays out on the other.  Alike on both sides it
could not be seen: what one motor spends winding in, the other spends when the arm turns back.
"""

import numpy as np
from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

REPLACED = ("thinning_speed",)
TYPICAL = 1.8e-5  # N·m·s/rad


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Damping in each direction, and the speed at which it thins."""
    hard = TYPICAL * rng.uniform(0.85, 1.15, size=SIDES)
    grease = np.column_stack([hard, hard * rng.uniform(0.1, 0.33, size=SIDES)])
    mirrored = rng.integers(SIDES)
    grease[mirrored] = grease[mirrored, ::-1]
    return {"grease": strength * grease, "thinning_speed": rng.uniform(80.0, 200.0)}
