"""A weight at the tip that nobody mentioned.

Typical 35 g on an arm of 320 g, at the end of the last unit, with some size of its own.  On a level
table only its inertia is felt; with more than 60 g the tip swings about its path.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal

TYPICAL = 0.035  # kg
RADIUS = 0.012  # m, of gyration


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """First moments and inertias with a body at the end of the last unit."""
    mass = strength * TYPICAL * rng.uniform(0.8, 1.2)
    length = nominal["length"]
    inertia = mass * length**2
    inertia[-1] += mass * RADIUS**2
    return {"first_moment": mass * length, "inertia": inertia}
