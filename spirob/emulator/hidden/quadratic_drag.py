"""Drag that grows faster than speed: a fan on the shaft, or a gear that churns its oil.

Typical D = 0.4 µN·m at 1 rad/s with an exponent from 1.7 to 2.2, so that 40 rad/s cost 0.6 mN·m,
an eighth of a typical torque; sides differ.  Source: churning losses, exponents of 1.5-2.5.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

REPLACED = ("fan_power",)
SPEED = 40.0  # rad/s, where the drag is as large as TYPICAL says, whatever the exponent
TYPICAL = 0.6e-3  # N·m at the rotor


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Drag at a typical speed, and how it grows."""
    power = rng.uniform(1.7, 2.2)
    level = strength * TYPICAL * rng.uniform(0.8, 1.2, size=SIDES)
    return {"fan": level / SPEED**power, "fan_power": power}
