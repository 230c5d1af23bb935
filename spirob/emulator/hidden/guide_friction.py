"""Friction of the tendons on their guides: the default, because printed arms have it.

Typical μ₀ ≈ 0.05, braided line in polished printed holes: above about 0.07 the antagonist buckles
the arm, which is a study of its own (published fits of printed arms need
0.25-0.4 where a rough 0.1-0.2 would be expected), different on the two sides, rough or smooth from
hole to hole, falling with load as polymers do; sticks over 0.1-0.2 mm.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics.compiled import HINGES, SIDES

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
