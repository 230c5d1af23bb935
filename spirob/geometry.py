"""The logarithmic-spiral law of the arm: published lengths and angles, no physics.

The spiral r(θ) = a·exp(bθ) is cut every Δθ into units that are similar to each other: each is the
one before it scaled by γ⁻¹ = exp(-bΔθ) towards the tip.  Straightened, the units lie along +x
from the base (unit 1) to the tip (unit N); hinge i is where unit i meets the one before it, and
its axis is +z.  Neighbouring faces are slanted by Δθ/2 each, so that they touch when the hinge has
turned by Δθ.  A tendon runs through the faces at a height that falls linearly from base to tip.

Sources: Wang, Freris, Wei, "SpiRobs", Device 2024; the default design of the published design
tool (length 464.08 mm, base 83.70 mm, tip 10.00 mm for 24 units of 30°).
"""

from dataclasses import dataclass

import numpy as np

SPIRAL_GROWTH = 0.1764  # b, 1/rad; default of the published design tool
SPIRAL_TURN = 4 * np.pi  # rad; 24 units of 30 degrees
ARM_LENGTH = 0.46408  # m; published length of the discretised default design
BASE_WIDTH = 0.083704  # m; published width of the base unit
GUIDE_HEIGHT_BASE = 0.9  # tendon height over half width at the base
GUIDE_HEIGHT_TIP = 0.5  # the same at the tip


@dataclass(frozen=True)
class SpiralArm:
    """Lengths of an arm cut into `units` similar units; arrays run from base to tip.

    unit_angle      Δθ [rad], the angle between neighbouring faces of the straight arm
    scale           size of each unit relative to the base unit, (N,), scale[0] = 1
    unit_length     [m] (N,), their sum is the arm's length
    hinge_position  x of each hinge in the straight arm [m] (N,), hinge_position[0] = 0
    half_width      [m] (N,), half the width of each unit at its middle
    guide_before    (N, 2) tendon guide on the face before each hinge (on the unit nearer the
                    base, or on the mount for hinge 1), as (x, y) relative to the hinge [m], for
                    the tendon on the +y side; the other tendon is its mirror image
    guide_after     (N, 2) the same on the face after the hinge
    """

    unit_angle: float
    scale: np.ndarray
    unit_length: np.ndarray
    hinge_position: np.ndarray
    half_width: np.ndarray
    guide_before: np.ndarray
    guide_after: np.ndarray

    @property
    def units(self) -> int:
        """Number of units, which is also the number of hinges."""
        return len(self.unit_length)


def spiral_arm(units: int = 24, size: float = 1.0) -> SpiralArm:
    """Cut the published arm into `units` units over the same total turn and length.

    units  how many hinges; 24 is the published arm, 48 the same arm cut twice as fine
    size   scale of the whole arm; 1 is the 464 mm default design
    """
    angle = SPIRAL_TURN / units
    scale = np.exp(-SPIRAL_GROWTH * angle * np.arange(units))
    unit_length = size * ARM_LENGTH * scale / scale.sum()
    hinge = np.concatenate([[0.0], np.cumsum(unit_length)[:-1]])
    # the published base width belongs to the middle of the first of 24 units
    offset = SPIRAL_GROWTH * (SPIRAL_TURN / 24 - angle) / 2
    half_width = size * BASE_WIDTH / 2 * np.exp(offset) * scale
    before, after = _guides(hinge, angle, size)
    return SpiralArm(angle, scale, unit_length, hinge, half_width, before, after)


def _guides(hinge: np.ndarray, angle: float, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Where the tendon's straight line y(x) = y0 + slope·x meets the two faces of each hinge."""
    tip_half_width = BASE_WIDTH / 2 * np.exp(-SPIRAL_GROWTH * SPIRAL_TURN * 23 / 24)
    base_height = size * GUIDE_HEIGHT_BASE * BASE_WIDTH / 2
    slope = (size * GUIDE_HEIGHT_TIP * tip_half_width - base_height) / (size * ARM_LENGTH)
    face = np.tan(angle / 2)
    axis_height = base_height + slope * hinge
    y_before = axis_height / (1 + slope * face)
    y_after = axis_height / (1 - slope * face)
    before = np.column_stack([-face * y_before, y_before])
    after = np.column_stack([face * y_after, y_after])
    return before, after
