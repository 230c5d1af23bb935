"""Torque that depends on the angle: magnets against slots, and an eccentric gear.

Harmonics of the rotor angle: once per turn of the winch and of a planet (eccentric gear), the 7
pole pairs and their double (phase unbalance), and six times that.  At G = 19 the magnets' orders
pass at hundreds of hertz, so the slow ones carry most of what is seen: typical 0.7 mN·m at the
rotor, a seventh of a typical torque.  Source: 7 pole pairs measured by others; sizes assumed.
"""

import numpy as np
from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES
from spirob.emulator.physics.motor import HARMONICS

REPLACED = ("cogging_order", "cogging_phase")
SIZES = np.array([0.7e-3, 0.25e-3, 0.3e-3, 0.2e-3, 0.25e-3])  # N·m
PLANET = 0.276  # turns of a planet wheel per rotor turn, assumed


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Amplitude, order and phase of each harmonic on each side."""
    slow = 1.0 / nominal["gear_ratio"]
    orders = np.array([slow, PLANET, 7.0, 14.0, 42.0])
    shape = (SIDES, HARMONICS)
    return {
        "cogging_torque": strength * SIZES * rng.uniform(0.7, 1.3, size=shape),
        "cogging_order": np.broadcast_to(orders, shape),
        "cogging_phase": rng.uniform(0.0, 2 * np.pi, size=shape),
    }
