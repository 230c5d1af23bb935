"""A drive that smooths the current before it reports it, the loop itself untouched.

Two equal poles of typically 40 ms each, as a firmware has that averages averages.
"""

import numpy as np
from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

TYPICAL = 0.040  # s


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Time of each pole; the same firmware on both sides."""
    return {"filter_time": strength * TYPICAL * rng.uniform(0.8, 1.2) * np.ones(SIDES)}
