"""A gear that loses more the more torque it carries, whichever way it turns.

Typical loss 8 % of the transmitted torque in either direction, on top of the constant efficiency;
the two sides differ.  Source: planetary gears of two stages, 0.9-0.97 a stage.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

REPLACED = ("bristle_angle",)
TYPICAL = 0.08


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Loss over transmitted torque, and the rotor angle over which it turns round."""
    return {
        "gear_loss": strength * TYPICAL * rng.uniform(0.8, 1.2, size=SIDES),
        "bristle_angle": rng.uniform(0.01, 0.05),
    }
