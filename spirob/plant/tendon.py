"""Geometry of a tendon at one hinge, in closed form, and where its holes lie.

The guides before and after hinge i are at fixed distances ρ_b, ρ_a from it; the straight arm sees
them at the angle β.  The length between them depends on that hinge alone,

    ℓ(q)² = ρ_b² + ρ_a² - 2 ρ_b ρ_a cos(β - σ q),        σ = +1 for the left tendon, -1 right,

so the tendon's Jacobian needs no kinematics of the chain.  Between the faces of one unit its
length is constant.

A hinge that is no point, but a flexure that bends over a length, is n hinges of q/n with n gaps of
β/n between guides at the same height: ℓ is n times that of one of them.  This matters where both
tendons pull.  A tendon that cuts a corner as a chord gains leverage as the corner closes, so that
two tendons of tension T at height y push the hinge over with T y tan(β/2n)/n a radian, less a part
for the taper of the line: at 4 N with 25 % of the base hinge's stiffness for n = 1, 4 % for n = 2.

The holes need not lie where the published drawing has them.  Between two hinges a tendon runs
through a hole of its unit, from a mouth near the base to one near the tip.  On the drawing the
mouths lie on the unit's faces, all of them on one straight line of the straight arm.  Other designs
have them elsewhere,

    x = x_drawn + σL (units)      x = x_drawn - x_0 (mount)      y = κ y(x)

with L the unit's length and σ shift, x_0 mount, κ height of `Holes`, and y(x) the straight line on
which the unit's hole runs.  How far σ and x_0 may go follows from how deep the mouths lie in their
units: on the published arm a hole stays within its unit for -0.2 < σ < 0.2, and behind the first
hinge for x_0 > -10 mm; on another these numbers grow with the depth.
"""

import math
from dataclasses import replace

import numpy as np

from spirob.geometry import SpiralArm, spiral_arm
from spirob.parameter import Parameter
from spirob.plant.rig import Holes


def small_angle(x):
    """Sine and cosine, by their series: to 2e-16 up to 1 rad, 1e-11 up to 2.

    A hinge turns by half a radian, and without branches the compiler takes four hinges at a time.
    """
    y = x * x
    sine = -1.0 / 121645100408832000.0
    sine = 1.0 / 355687428096000.0 + y * sine
    sine = -1.0 / 1307674368000.0 + y * sine
    sine = 1.0 / 6227020800.0 + y * sine
    sine = -1.0 / 39916800.0 + y * sine
    sine = 1.0 / 362880.0 + y * sine
    sine = -1.0 / 5040.0 + y * sine
    sine = 1.0 / 120.0 + y * sine
    sine = -1.0 / 6.0 + y * sine
    sine = 1.0 + y * sine
    cosine = -1.0 / 6402373705728000.0
    cosine = 1.0 / 20922789888000.0 + y * cosine
    cosine = -1.0 / 87178291200.0 + y * cosine
    cosine = 1.0 / 479001600.0 + y * cosine
    cosine = -1.0 / 3628800.0 + y * cosine
    cosine = 1.0 / 40320.0 + y * cosine
    cosine = -1.0 / 720.0 + y * cosine
    cosine = 1.0 / 24.0 + y * cosine
    cosine = -1.0 / 2.0 + y * cosine
    cosine = 1.0 + y * cosine
    return x * sine, cosine


def half_angle(q, bends):
    """sin(q/2n), cos(q/2n): all that the guides of both tendons need of a hinge angle."""
    return small_angle(0.5 * q / bends)


def guide_length(side, sine, cosine, product, gap_squared, sine_open, cosine_open, bends):
    """Length between the guides [m] and its shortening per bend -dℓ/d(σq) [m/rad].

    side             σ;  sine, cosine  of q/2n;  bends  n
    product          ρ_b·ρ_a [m²];  gap_squared  (ρ_b - ρ_a)² [m²];  of one bend
    sine_open, cosine_open  of β/2n

    With h = (β - σq)/2, ℓ² = (ρ_b - ρ_a)² + 4ρ_bρ_a sin²h, which keeps its digits where the guides
    nearly meet.  Beyond σq = β they have met: the length stays, and the tendon turns the hinge no
    further (an impact may carry it there for a step).
    """
    sine_half = max(0.0, sine_open * cosine - side * cosine_open * sine)
    cosine_half = cosine_open * cosine + side * sine_open * sine
    length = math.sqrt(gap_squared + 4.0 * product * sine_half * sine_half)
    lever = 2.0 * product * sine_half * cosine_half / max(length, 1e-12)  # guides that have met
    return bends * length, lever


def pose_tendons(qpos, qvel, columns, rest, arm, shortening, shortening_rate, work):
    """Both tendons, left then right, in this pose of the arm.

    columns     (10, N) rows of `guides`, turned, of the left tendon, then of the right one
    rest        lengths in the straight arm [m], (2, N)
    arm         (2, N) filled with the shortening per hinge angle [m/rad]
    shortening  (2,) filled [m];  shortening_rate  (2,) filled [m/s];  work  (3, N) is scratch
    """
    hinges = columns.shape[1]
    sine, cosine, shorter = work[0], work[1], work[2]
    for i in range(hinges):
        sine[i], cosine[i] = half_angle(qpos[i], columns[4, i])
    for m in range(2):
        side = 1.0 - 2.0 * m
        first = 5 * m
        # apart from the sums, so that the compiler takes four hinges at a time
        for i in range(hinges):
            length, lever = guide_length(
                side,
                sine[i],
                cosine[i],
                columns[first, i],
                columns[first + 1, i],
                columns[first + 2, i],
                columns[first + 3, i],
                columns[first + 4, i],
            )
            shorter[i] = rest[m, i] - length
            arm[m, i] = side * lever
        total, slide = 0.0, 0.0
        for i in range(hinges):
            total += shorter[i]
            slide += arm[m, i] * qvel[i]
        shortening[m], shortening_rate[m] = total, slide


def guides(geometry: SpiralArm, bends: float = 1.0) -> np.ndarray:
    """ρ_b·ρ_a, (ρ_b - ρ_a)², sin β/2n, cos β/2n and n of each hinge, (N, 5), in metres.

    bends  n; the guides of a narrower gap at the same height stand nearer to its hinge
    """
    before, after = geometry.guide_before, geometry.guide_after
    near, far = np.hypot(*before.T), np.hypot(*after.T)
    opening = np.arctan2(before[:, 1], before[:, 0]) - np.arctan2(after[:, 1], after[:, 0])
    half = opening / 2 / bends
    nearer = (np.cos(opening / 2) / np.cos(half)) ** 2
    gap = (near - far) / bends
    columns = [near * far * nearer, gap**2, np.sin(half), np.cos(half), np.full(len(half), bends)]
    return np.column_stack(columns)


def shortenings(angles: np.ndarray, *columns: np.ndarray) -> np.ndarray:
    """By how much both tendons are shorter than on the straight arm, left then right [m], (2,).

    angles  of the hinges [rad], (N,);  columns  of `guides`: of both sides, or of one each
    """
    found = np.zeros(2)
    for k, side in enumerate((1.0, -1.0)):
        for angle, row in zip(angles, columns[min(k, len(columns) - 1)], strict=True):
            straight, _ = guide_length(side, 0.0, 1.0, *row)
            found[k] += straight - guide_length(side, *half_angle(angle, row[4]), *row)[0]
    return found


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


def scattered(geometry: SpiralArm, off: np.ndarray) -> SpiralArm:
    """The arm with the holes of one side elsewhere, both mouths of each together.

    off  along the arm and outwards, over the size of the unit [m], (N + 1, 2): the mount's hole,
         then those of the units
    """
    moved = np.append(geometry.scale[0], geometry.scale)[:, None] * off
    return replace(
        geometry,
        guide_before=geometry.guide_before + moved[:-1],
        guide_after=geometry.guide_after + moved[1:],
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
