"""Hinges that harden as they bend: k(1 + a|x|ⁿ), x the angle over the end stop's.

Typical a = 4.5 (5.5 times the moment just before the stop), n from 2 to 4, differing from hinge to
hinge: the elastic layer is stretched as well as bent, and faces touch at their rims first.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import HINGES

REPLACED = ("hardening_power",)
TYPICAL = 4.5


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Hardening of every hinge and its exponent."""
    return {
        "hardening": strength * TYPICAL * rng.lognormal(0.0, 0.25, size=HINGES),
        "hardening_power": rng.uniform(2.0, 4.0),
    }
