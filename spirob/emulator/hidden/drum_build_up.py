"""Tendon that winds on top of itself: the drum grows as it winds in, and is not quite round.

Line of 0.8-1.4 mm on a drum of 20 mm adds 4-7 % of radius a turn where it stacks; the crossing of
layers makes the drum 0.5-1.5 % eccentric.
"""

import numpy as np
from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

LINE = (0.8e-3, 1.4e-3)  # m


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Growth per turn, eccentricity and its phase."""
    line = rng.uniform(*LINE) * rng.uniform(0.9, 1.1, size=SIDES)
    return {
        "winch_growth": strength * line / nominal["winch_radius"],
        "winch_eccentricity": strength * rng.uniform(0.005, 0.015, size=SIDES),
        "winch_phase": rng.uniform(0.0, 2 * np.pi, size=SIDES),
    }
