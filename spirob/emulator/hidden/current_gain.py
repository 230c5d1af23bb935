"""A current sensor whose ampere is not an ampere.

Typical 10 % too much or too little, each side on its own.  In the logs this is the same as another
torque constant or efficiency, so it is no missing effect but a wrong parameter: kept as a trap.
Source: shunt tolerance of hobby drives, 1-10 %.
"""

import numpy as np
from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

TYPICAL = 0.1


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """What is added to the sensor's gain, either sign, smaller than one."""
    sign = rng.choice([-1.0, 1.0], size=SIDES)
    gain = np.clip(strength * TYPICAL * sign * rng.uniform(0.75, 1.25, size=SIDES), -0.5, 0.5)
    return {"sensor_gain": gain}
