"""Iron that saturates: an ampere gives less torque the more of them flow.

Fröhlich's curve with a drawn knee, 1/(1 + (|i|/i_s)ⁿ)^(1/n), n from 1.6 to 2.2, typical i_s = 2 A,
so that 0.5 A lose some percent and the stalled 5 A more than half.  A motor wound for less than
this drive can give; sides differ a little.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

REPLACED = ("saturation_power",)
CURRENT = 2.0  # A


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Reciprocal of the current at which the curve bends, and how sharply."""
    return {
        "saturation": strength / CURRENT * rng.uniform(0.9, 1.1, size=SIDES),
        "saturation_power": rng.uniform(1.6, 2.2),
    }
