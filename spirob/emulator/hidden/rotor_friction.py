"""Dry friction of the rotor: bristles with a breakaway peak and a Stribeck fall.

Typical sliding level 0.45 mN·m at the rotor, 5-10 % of 0.3-0.6 A; the breakaway excess is
a third to two thirds of it and is gone above a few rad/s.  Sides differ by a fifth.
Source: Canudas de Wit, Olsson, Åström, Lischinsky 1995 (LuGre); level assumed.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

REPLACED = ("stribeck_speed", "bristle_angle")
TYPICAL = 0.45e-3  # N·m at the rotor


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Sliding level, breakaway excess, and the speed and angle over which they change."""
    level = strength * TYPICAL * rng.uniform(0.8, 1.2, size=SIDES)
    return {
        "coulomb": level,
        "breakaway": level * rng.uniform(0.33, 0.67),
        "stribeck_speed": rng.uniform(3.0, 12.0),
        "bristle_angle": rng.uniform(0.005, 0.02),
    }
