"""Printed TPU that keeps yielding: every hinge creeps with three relaxation times.

Typical: the hinge is 2.8 times as stiff at once as in the long run, spread over tenths of a second,
seconds and tens of seconds; each hinge a little differently.  A Prony series, as viscoelastic
data sheets of TPU have it; soft grades relax to a third.  Less would be lost in the current, most
of which goes into the antagonist and the rotor.
"""

import numpy as np
from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import HINGES
from spirob.emulator.physics.arm import CREEP_ARMS

REPLACED = ("creep_time",)
TYPICAL = 1.8
TIMES = np.array([0.15, 1.2, 10.0])  # s


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Share of stiffness and relaxation time of each arm of the series."""
    shares = rng.dirichlet([8.0] * CREEP_ARMS)
    hinges = rng.lognormal(0.0, 0.1, size=HINGES)
    return {
        "creep_share": strength * TYPICAL * shares[:, None] * hinges,
        "creep_time": TIMES * rng.lognormal(0.0, 0.2, size=CREEP_ARMS),
    }
