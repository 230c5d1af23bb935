"""A winding that warms quickly: its resistance rises and its magnets weaken.

Typical: a hot spot of 10 mJ/K against 700 K/W takes up all copper loss, with magnets at -0.4 %/K,
so that 0.4 A warm it by some ten kelvin within seconds and cost 4 % of torque.  Radiation keeps it
below 120 K when the motor stalls at 5 A.  The data sheet's motor (40 J/K, 2 K/W) would warm by less
than 0.1 K in such a trial: this is a winding in a bad pot, exaggerated so that it is seen at all.
Source: temperature coefficients of copper and of bonded NdFeB/ferrite; heat path assumed.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

REPLACED = ("heat_capacity", "heat_resistance")
COPPER = 0.0039  # 1/K
CAPACITY = 0.01  # J/K
RESISTANCE = 700.0  # K/W
RADIATION = 1 / 30.0  # 1/K; above 30 K most heat is radiated


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Hot spot in parallel with the data sheet's heat path, and how the magnets follow it."""
    hot = strength * rng.uniform(0.85, 1.15, size=SIDES)
    return {
        "heat_capacity": 1.0 / (1.0 / nominal["heat_capacity"] + hot / CAPACITY),
        "heat_resistance": nominal["heat_resistance"] + hot * RESISTANCE,
        "heat_escape": RADIATION,
        "resistance_heating": COPPER,
        "magnet_heating": rng.uniform(0.003, 0.005),
    }
