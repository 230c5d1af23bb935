"""A tendon that keeps growing under load: two terms of a Prony series of compliances.

Typical 0.6 mm/N in the long run, shared between some tenths of a second and some seconds, which is
wound in and does not bend the arm; gone again as slowly when the load goes.
Source: creep of polymer line in data sheets; size assumed.
"""

import numpy as np
from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

REPLACED = ("tendon_creep_time",)
TYPICAL = 6e-4  # m/N
TIMES = np.array([0.4, 4.0])  # s


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Compliance of each term on each side, and their times."""
    shares = rng.dirichlet([6.0, 6.0], size=SIDES)
    sides = rng.uniform(0.85, 1.15, size=(SIDES, 1))
    return {
        "tendon_creep": strength * TYPICAL * sides * shares,
        "tendon_creep_time": TIMES * rng.lognormal(0.0, 0.2, size=len(TIMES)),
    }
