"""Where the tendons' holes lie, if not where the published drawing has them.

Between two hinges a tendon runs through a hole of its unit, from a mouth near the base to one near
the tip.  On the drawing the mouths lie on the unit's faces, all of them on one straight line
y = y(x) of the straight arm.  Other designs have them elsewhere,

    x = x_drawn + σL (units)      x = x_drawn - x_0 (mount)      y = κ y(x)

with L the unit's length and σ shift, x_0 mount, κ height of `Holes`.  A hole stays within its unit
for -0.2 < σ < 0.2, and behind the first hinge for x_0 > -10 mm.
"""

from dataclasses import replace

import numpy as np

from spirob.geometry import SpiralArm
from spirob.plant.nominal import Holes


def with_holes(geometry: SpiralArm, holes: Holes) -> SpiralArm:
    """The arm with its holes where the numbers say; the very same arm at the drawing's numbers."""
    if holes == Holes():
        return geometry
    before, after = geometry.guide_before, geometry.guide_after
    slope = (after[0, 1] - before[0, 1]) / (after[0, 0] - before[0, 0])
    moved = holes.shift * geometry.unit_length
    far = before[:, 0] + np.append(-holes.mount, moved[:-1])
    near = after[:, 0] + moved
    level = after[:, 1] - slope * after[:, 0]  # y of the line at each hinge
    return replace(
        geometry,
        guide_before=np.column_stack([far, holes.height * (level + slope * far)]),
        guide_after=np.column_stack([near, holes.height * (level + slope * near)]),
    )
