"""A gearbox with play: a true dead zone between rotor and drum.

Typical half gap 20 mrad at the drum, a worn gear, 0.4 mm of tendon.  A taut tendon keeps its gear
on one flank, so the logs show it only where tension sets in or is lost: in the first half second of
a trial, which starts in the middle of the gap, and in slack.
"""

import numpy as np
from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

TYPICAL = 0.02  # rad


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Half the gap of each side, a third of a turn at most."""
    gap = strength * TYPICAL * rng.uniform(0.8, 1.2, size=SIDES)
    return {"gear_play": np.minimum(gap, 1.0)}
