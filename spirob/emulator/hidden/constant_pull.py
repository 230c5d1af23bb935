"""Something outside that pulls at the line: a weight on a string, or a long spring on the drum.

Typical 0.5 N on one tendon, drawn with its sign, and a twentieth of that on the other, with a
little stiffness, so that it changes by some percent over the stroke.  Two pulls alike would nearly
cancel, since what one motor gains the other's tendon takes.
"""

from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import SIDES

TYPICAL = 0.5  # N
STIFFNESS = 1.0  # N/m


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Pull with its sign, and the stiffness of what pulls."""
    pull = TYPICAL * rng.uniform(0.8, 1.2, size=SIDES) * rng.choice([-1.0, 1.0], size=SIDES)
    pull[rng.integers(SIDES)] *= 0.05
    return {
        "outside_pull": strength * pull,
        "outside_stiffness": strength * STIFFNESS * rng.uniform(0.5, 1.5, size=SIDES),
    }
