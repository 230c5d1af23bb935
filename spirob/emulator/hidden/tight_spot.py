"""A winch that rubs over a part of its turn: a bearing that was pressed in askew, a burr.

Both drums come from one mould and carry their line at the same place, so the spot lies at much the
same angle of both, counted from where the arm is straight; it takes a seventh of a turn or less.
Typical friction at its middle 0.9 mN·m at the rotor; the two sides differ by a fifth.  The library
of effects holds no friction of a place.  Size and width assumed.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

REPLACED = ("tight_angle", "tight_width", "bristle_angle")
TYPICAL = 0.9e-3  # N·m at the rotor
APART = 0.01  # rad, by which the two drums differ


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Friction in the middle of the spot, where it lies and how wide it is."""
    return {
        "tight": strength * TYPICAL * rng.uniform(0.8, 1.2, size=SIDES),
        "tight_angle": rng.uniform(0.25, 0.55) + rng.uniform(-APART, APART, size=SIDES),
        "tight_width": rng.uniform(0.07, 0.15),
        "bristle_angle": rng.uniform(0.01, 0.05),
    }
