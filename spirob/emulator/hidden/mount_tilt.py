"""A table that is not level: part of the weight acts in the plane of the arm.

Typical 12°, in any direction of the plane, so that the arm sags to one side before anything pulls.
"""

import numpy as np
from numpy.random import Generator

from spirob.emulator.hidden import Nominal

TYPICAL = np.deg2rad(12.0)
GRAVITY = 9.81  # m/s²


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Gravity in the plane; mostly across the arm, since along it nothing bends."""
    angle = min(strength * TYPICAL * rng.uniform(0.8, 1.2), np.pi / 2)
    heading = rng.choice([-1.0, 1.0]) * rng.uniform(np.pi / 4, 3 * np.pi / 4)
    return {"gravity": GRAVITY * np.sin(angle) * np.array([np.cos(heading), np.sin(heading)])}
