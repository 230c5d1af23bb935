"""A gear that loses more when the load drives it: directional efficiency.

The constant efficiency speaks of driving; back-driven, a planetary gear loses again, typically
15 % of the torque it carries, and its motor then has to hold less.  The loss fades in as the teeth
reverse (bristles over 10-50 mrad of the rotor).  Source: Wang, Kim 2015, measured gears whose
backward efficiency is 5-30 % lower; size assumed.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

REPLACED = ("bristle_angle",)
TYPICAL = 0.15


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Loss over transmitted torque while back-driven, and the angle of reversal."""
    return {
        "back_loss": strength * TYPICAL * rng.uniform(0.8, 1.2, size=SIDES),
        "bristle_angle": rng.uniform(0.01, 0.05),
    }
