"""A drive that swallows small commands: dead time of the bridge, uncompensated.

Typical 35 mA are missing from every command, with a soft knee round zero and a different width for
each direction.  What the drive reports is the current that really flows.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

TYPICAL = 0.035  # A


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Width of the band for commands that wind in and for those that pay out."""
    return {"dead_band": strength * TYPICAL * rng.uniform(0.8, 1.2, size=(SIDES, 2))}
