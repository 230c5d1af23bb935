"""A soft tendon: braid that first straightens its strands, then stretches.

Typical 3 mm longer at 8 N than the stiff line that the machine otherwise has, over a toe of about
1 mm; seen as tendon wound in that does not bend the arm.  Source: nylon and polyester braid of
0.5 m, 3-10 kN/m; toe of Fung's exponential.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

REPLACED = ("tendon_stiffness",)
COMPLIANCE = 1 / 4000.0  # m/N
TOE = 1e-3  # m


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Stiffness with the soft line in series, and its toe."""
    compliance = strength * COMPLIANCE * rng.uniform(0.8, 1.2, size=SIDES)
    return {
        "tendon_stiffness": 1.0 / (1.0 / nominal["tendon_stiffness"] + compliance),
        "tendon_toe": strength * TOE * rng.uniform(0.6, 1.4),
    }
