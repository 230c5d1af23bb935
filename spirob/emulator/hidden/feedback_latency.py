"""Frames that arrive late: a drive that queues, or a bus bridge that collects.

Typical 12 cycles for angle, speed and current alike, up to two more on one side.  The controller
sees the same late frames, and from about 20 cycles on its velocity loop rings: never more than 18.
"""

import numpy as np
from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

TYPICAL = 12  # cycles of 1 ms
MOST = 18


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Delay of each side in whole cycles."""
    cycles = strength * (TYPICAL * rng.uniform(0.8, 1.2) + rng.uniform(0.0, 2.0, size=SIDES))
    return {"latency": np.clip(np.round(cycles), 0, MOST)}
