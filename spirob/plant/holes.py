"""Where the tendons' holes lie, if not where the published drawing has them.

Between two hinges a tendon runs through a hole of its unit, from a mouth near the base to one near
the tip.  On the drawing the mouths lie on the unit's faces, all of them on one straight line of the
straight arm.  Other designs have them elsewhere,

    x = x_drawn + σL (units)      x = x_drawn - x_0 (mount)      y = κ y(x)

with L the unit's length and σ shift, x_0 mount, κ height of `Holes`, and y(x) the straight line on
which the unit's hole runs.  How far σ and x_0 may go follows from how deep the mouths lie in their
units: on the published arm a hole stays within its unit for -0.2 < σ < 0.2, and behind the first
hinge for x_0 > -10 mm; on another these numbers grow with the depth.
"""

from dataclasses import replace

import numpy as np

from spirob.geometry import SpiralArm, spiral_arm
from spirob.parameter import Parameter
from spirob.plant.nominal import Holes
from spirob.plant.tendon import guides, shortenings

SHIFT, MOUNT = (-0.2, 0.2), (-0.01, 0.03)  # of the published arm: of a unit's length, [m]
LEAST = 0.02, 5e-4  # depth, of a unit's length and [m], that a caliper does not tell from none


def with_holes(geometry: SpiralArm, holes: Holes) -> SpiralArm:
    """The arm with its holes where the numbers say; the very same arm at the drawing's numbers."""
    if holes == Holes():
        return geometry
    before, after = geometry.guide_before, geometry.guide_after
    moved = holes.shift * geometry.unit_length
    along = np.append(-holes.mount, moved[:-1])
    slope = _slopes(geometry)
    return replace(
        geometry,
        guide_before=_moved(before, along, np.append(slope[0], slope[:-1]), holes.height),
        guide_after=_moved(after, moved, slope, holes.height),
    )


def stroke(geometry: SpiralArm) -> float:
    """Length that a tendon winds in from the straight arm until all faces meet [m]."""
    return float(shortenings(geometry.hinge_angle, guides(geometry))[0])


def _slopes(geometry: SpiralArm) -> np.ndarray:
    """dy/dx of the hole of each unit, (N,); the last unit's mouth at the tip is not in the record,
    so that it has the slope of the one before."""
    near, far = geometry.guide_after[:-1], geometry.guide_before[1:].copy()
    far[:, 0] += geometry.unit_length[:-1]
    slope = (far[:, 1] - near[:, 1]) / (far[:, 0] - near[:, 0])
    return np.append(slope, slope[-1])


def _moved(mouths: np.ndarray, along: np.ndarray, slope: np.ndarray, height: float) -> np.ndarray:
    return np.column_stack([mouths[:, 0] + along, height * (mouths[:, 1] + slope * along)])


def room(geometry: SpiralArm) -> dict[str, Parameter]:
    """What the numbers of `Holes` may be on this arm, by name."""
    about, depth = Holes.parameters(), _depth(geometry) / _depth(spiral_arm())
    return {
        f"{Holes.owner}.{name}": replace(
            about[name],
            low=max(about[name].low, times * low),
            high=min(about[name].high, times * high),
        )
        for name, times, (low, high) in zip(
            ("shift", "mount"), depth.tolist(), (SHIFT, MOUNT), strict=True
        )
    }


def _depth(geometry: SpiralArm) -> np.ndarray:
    """How deep mouths lie: of units the least share of their length, of the mount [m]."""
    inside = geometry.guide_after[:, 0] / geometry.unit_length
    return np.maximum([inside.min(), -geometry.guide_before[0, 0]], LEAST)
