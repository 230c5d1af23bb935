"""An encoder magnet that sits off centre: angle and speed are modulated once and twice a turn.

Typical 3° once and 1° twice a rotor turn.  Hardly a length (50 µm of tendon at G = 19), but a
twentieth of the speed, to which the controller answers with current.
Source: magnetic encoders, 0.2-0.5 mm off axis give 1-3°.
"""

import numpy as np
from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

REPLACED = ("encoder_phase",)
TYPICAL = np.deg2rad([3.0, 1.0])


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Amplitude and phase of both harmonics on each side; the angle never runs backwards."""
    error = strength * TYPICAL * rng.uniform(0.8, 1.2, size=(SIDES, 2))
    return {
        "encoder_error": np.minimum(error, [0.5, 0.2]),
        "encoder_phase": rng.uniform(0.0, 2 * np.pi, size=(SIDES, 2)),
    }
