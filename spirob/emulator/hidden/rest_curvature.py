"""An arm that is not straight when nothing pulls: the print cooled unevenly or was stored curled.

Typical 240° in all from base to tip (of 690° to the end stop), to one side, more where the arm is
thin, with a little wave.  Displacement counts from rest, so nothing is seen of it to first order:
what remains are the levers of a bent arm, and stops that come early on one side and late on the
other.  Beyond one and a half times typical the hinges at the tip rest near their stops.
"""

import numpy as np
from numpy.random import Generator

from spirob.emulator.hidden import Nominal
from spirob.emulator.physics import HINGES

TYPICAL = np.deg2rad(240.0)


def numbers(strength: float, rng: Generator, nominal: Nominal) -> dict:
    """Angle of every hinge at rest; the sum over the arm is the typical bend."""
    along = np.linspace(0.0, 1.0, HINGES)
    shape = 1.0 + rng.uniform(0.0, 1.5) * along
    shape += 0.3 * np.sin(2 * np.pi * (along * rng.uniform(1.0, 2.5) + rng.uniform()))
    total = TYPICAL * rng.uniform(0.8, 1.2) * rng.choice([-1.0, 1.0])
    limit = 0.8 * nominal["stop_angle"]
    return {"rest_angle": np.clip(strength * total * shape / shape.sum(), -limit, limit)}
