"""Capstan friction of the tendons on their guides: the default, because printed arms have it.

Typical μ₀ ≈ 0.05, braided line in polished holes; different on the two sides, rough or smooth from
hole to hole, falling with load as polymers do; sticks over 0.1-0.2 mm.  Published fits of printed
arms give 0.25-0.4, but from about 0.07 a tensioned antagonist buckles this arm, a study of its own.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import HINGES, SIDES

REPLACED = ("guide_load_exponent", "guide_slip_distance")
TYPICAL = 0.05


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Coefficient of every hole, load exponent and slip distance."""
    sides = TYPICAL * rng.uniform(0.85, 1.15, size=(SIDES, 1))
    holes = rng.lognormal(0.0, 0.2, size=(SIDES, HINGES))
    return {
        "guide_friction": strength * sides * holes / holes.mean(axis=1, keepdims=True),
        "guide_load_exponent": rng.uniform(0.05, 0.15),
        "guide_slip_distance": rng.uniform(1e-4, 2e-4),
    }
