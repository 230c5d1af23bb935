"""A current sensor that is wrong: offset, gain and a drift while the drive warms up.

Typical offset 40 mA (33 counts), gain 2 %, drift another 24 mA over some seconds.  The drive
regulates what the sensor says, so the winding carries the error with the opposite sign.
Source: shunt amplifiers of hobby drives, offset of 0.3 % of 20 A; assumed.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

REPLACED = ("sensor_drift_time",)
OFFSET = 0.04  # A


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Offset with either sign, gain, and drift with its time constant."""
    sign = rng.choice([-1.0, 1.0], size=SIDES)
    return {
        "sensor_offset": strength * OFFSET * sign * rng.uniform(0.7, 1.3, size=SIDES),
        "sensor_gain": strength * 0.02 * rng.uniform(-1.0, 1.0, size=SIDES),
        "sensor_drift": strength * 0.024 * rng.uniform(-1.0, 1.0, size=SIDES),
        "sensor_drift_time": rng.uniform(3.0, 10.0),
    }
