"""A drum that is out of centre and oval: the lever of the tendon changes as it turns.

Typical 8 % once and 3 % twice a winch turn, phases drawn.  A printed drum on a shaft with play.
"""

import numpy as np
from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

REPLACED = ("winch_phase", "winch_oval_phase")


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Size and phase of both harmonics on each side."""
    once, twice = rng.uniform(0.8, 1.2, size=(2, SIDES)) * [[0.08], [0.03]]
    return {
        "winch_eccentricity": np.minimum(strength * once, 0.45),
        "winch_phase": rng.uniform(0.0, 2 * np.pi, size=SIDES),
        "winch_oval": np.minimum(strength * twice, 0.15),
        "winch_oval_phase": rng.uniform(0.0, 2 * np.pi, size=SIDES),
    }
