"""The outline of a unit that bends over its length.

A rigid unit touches an object with the middle of its edge.  In an arm that bends evenly, n times
between two hinges of the chain, each by q/n, that middle lies beyond the chord and the chord is
shorter than the unit.  Wound evenly by q a unit, the elastic axis passes the middle of an edge at

    r_n = L/(2n tan(q/2n))        from the centre of the turn,

to first order in q farther out than that of the rigid unit by

    r_n - r_1 = L q/12·(1 - 1/n²):

with n = 2 a sixteenth of L q.  So the outline is carried outwards by this much in each step, for as
long as there is something to touch.  The moment that a contact does along with this small motion is
left out: with n = 2, on each of the two hinges a sixteenth of what it does on the nearer one.
"""

import mujoco
import numpy as np

from spirob.geometry import SpiralArm
from spirob.robot import MOTORS

LINES = ("edge", "near_face", "far_face")  # of either side of a unit; near the base, far from it


def bow(geometry: SpiralArm, bends: float) -> np.ndarray:
    """How far the middle of each unit moves out per angle of its bend, (N,) [m/rad]."""
    return geometry.unit_length / 12.0 * (1.0 - 1.0 / bends**2)


def outlines(model: mujoco.MjModel, hinges: int) -> np.ndarray:
    """Numbers of the geoms of each unit's outline, (N, 6): edge and two faces of either side."""
    lines = [f"{motor}_{line}" for motor in MOTORS for line in LINES]
    names = [[f"{line}_{i}" for line in lines] for i in range(hinges)]
    return np.array([[model.geom(name).id for name in row] for row in names])


def bend_outline(qpos, bows, heights, numbers, positions):
    """Carry each unit's outline to where its bend, the mean of its two hinges, puts it.

    heights (N, 6) where its lines are in the straight arm [m];  positions (geoms, 3) MuJoCo's own
    """
    hinges = bows.shape[0]
    for i in range(hinges):
        bend = qpos[i] if i + 1 == hinges else 0.5 * (qpos[i] + qpos[i + 1])
        for line in range(numbers.shape[1]):
            positions[numbers[i, line], 1] = heights[i, line] - bows[i] * bend
