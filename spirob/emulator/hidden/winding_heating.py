"""A winding that warms quickly: its resistance rises and its magnets weaken.

Typical: a tenth of the data sheet's heat capacity reaches the sensor-side node within a trial,
copper 0.39 %/K, magnets -0.4 %/K, so that the torque of an ampere falls by some percent in 10 s
at 3 A.  Source: temperature coefficients of copper and of bonded NdFeB/ferrite; heat path assumed.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal

REPLACED = ("heat_capacity",)


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Small thermal mass, and how resistance and magnets follow its temperature."""
    share = 1.0 / (1.0 + strength * rng.uniform(20.0, 40.0))
    return {
        "heat_capacity": nominal["heat_capacity"] * share,
        "resistance_heating": 0.0039,
        "magnet_heating": strength * rng.uniform(0.003, 0.005),
    }
