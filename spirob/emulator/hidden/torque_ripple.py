"""Torque of an ampere that depends on where the rotor stands, in proportion to the current.

Five harmonics: once and twice a turn (one magnet or coil weaker), the 7 pole pairs, their double
and six times that (current offsets, gain mismatch of the phases, shape of the back-EMF).  Typical
8 % for the first; the high ones pass at tens of hertz and are mostly averaged out by inertia.
"""

import numpy as np
from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

REPLACED = ("ripple_order", "ripple_phase")
SIZES = np.array([0.08, 0.04, 0.02, 0.02, 0.02])
ORDERS = np.array([1.0, 2.0, 7.0, 14.0, 42.0])  # per rotor turn; 7 pole pairs


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Amplitude, order and phase of each harmonic on each side."""
    shape = (SIDES, len(ORDERS))
    return {
        "ripple": strength * SIZES * rng.uniform(0.7, 1.3, size=shape),
        "ripple_order": np.broadcast_to(ORDERS, shape),
        "ripple_phase": rng.uniform(0.0, 2 * np.pi, size=shape),
    }
