"""Bounded Gauss-Newton for a residual of which every evaluation is a simulation of all trials.

Between two sets of finite differences the derivatives are corrected with what each step has shown
(Broyden, Math. Comp. 19, 1965), so that a step costs one evaluation instead of one for each number.
In directions in which the data hold little, the numbers are held where they began by a weak anchor;
without it η, b_m, J_m and the stiffness drift together to a bound, which hides what is missing.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import scipy

from spirob.identify.problem import Problem
from spirob.identify.scaling import Scaling

STEPS_BETWEEN = 6  # between two sets of differences
SHORTEST = 0.004  # a step cut below this share of the reach ends the walk
REACH = 1.5  # of a shortened step, of the coordinates, times the share


@dataclass(frozen=True)
class Anchor:
    """Σ((u - place)/width)² is added to the squared residual over noise².

    place   coordinates that the data have to argue against
    width   by how much at one standard deviation, (n,) or one for all
    noise   residual of one independent sample that counts as one, in its unit
    """

    place: np.ndarray
    width: np.ndarray | float
    noise: float

    def cost(self, u: np.ndarray) -> float:
        """In the unit of `robust_cost`."""
        return 0.5 * float(np.sum(((u - self.place) * self._weight) ** 2))

    @property
    def _weight(self) -> np.ndarray | float:
        return self.noise / self.width

    def rows(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rows of the linear problem and their residual."""
        return np.eye(len(u)) * self._weight, self._weight * (u - self.place)


@dataclass(frozen=True)
class Descent:
    """Where it ended: coordinates, residual there, last derivatives, cost without the anchor."""

    u: np.ndarray
    residual: np.ndarray
    slopes: np.ndarray
    cost: float


def robust_cost(residual: np.ndarray, scale: float) -> float:
    """Σρ(r/s)·s²/2 with ρ(z) = 2(√(1+z²) - 1)."""
    square = (residual / scale) ** 2
    return float(np.sum(square / (np.sqrt(1.0 + square) + 1.0)) * scale**2)  # no cancellation


def linear_step(
    residual: np.ndarray,
    slopes: np.ndarray,
    bounds: tuple[np.ndarray, np.ndarray],
    scale: float,
    anchor: tuple[np.ndarray, np.ndarray] | None = None,
) -> np.ndarray:
    """argmin Σ w (r + J d)² within bounds on d, w being the weights of the robust loss at r."""
    weight = (1.0 + (residual / scale) ** 2) ** -0.25
    rows, target = slopes * weight[:, None], -residual * weight
    if anchor is not None:
        rows, target = np.vstack([rows, anchor[0]]), np.append(target, -anchor[1])
    low, high = np.minimum(bounds[0], -1e-9), np.maximum(bounds[1], 1e-9)
    # the triangular factor has the same solution, and is as small as the numbers are few
    orthogonal, triangle = np.linalg.qr(rows)
    target = orthogonal.T @ target
    return np.asarray(scipy.optimize.lsq_linear(triangle, target, (low, high), "bvls").x)


def corrected(slopes: np.ndarray, step: np.ndarray, change: np.ndarray) -> np.ndarray:
    """Derivatives that agree with the change of the residual that a step was seen to make."""
    length = float(step @ step)
    if length == 0.0:
        return slopes
    return np.asarray(slopes + np.outer(change - slopes @ step, step) / length)


def descend(
    value: Callable[[np.ndarray], np.ndarray],
    differences: Callable[[np.ndarray, np.ndarray], np.ndarray],
    start: np.ndarray,
    box: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    scale: float,
    rounds: int,
    settled: float,
    anchor: Anchor | None = None,
    slopes: np.ndarray | None = None,
) -> Descent:
    """Walk down from `start` until a fresh set of derivatives gains less than `settled`.

    value        residual at u;  differences  its derivatives at (u, residual there)
    box          lowest and highest u, seen from a u
    rounds       sets of differences at most
    slopes       derivatives at the start, where they are known already
    """
    u, residual = start, value(start)
    cost = robust_cost(residual, scale) + (anchor.cost(u) if anchor else 0.0)
    share = 1.0
    for k in range(rounds):
        if slopes is None or k > 0:
            slopes = differences(u, residual)
        before = cost
        for _ in range(STEPS_BETWEEN):
            least, most = box(u)
            low, high = least - u, most - u
            if share < 1.0:
                reach = REACH * share * np.maximum(1.0, np.abs(u))
                low, high = np.maximum(low, -reach), np.minimum(high, reach)
            rows = anchor.rows(u) if anchor else None
            moved = np.clip(
                u + linear_step(residual, slopes, (low, high), scale, rows), least, most
            )
            step = moved - u
            seen = value(moved)
            reached = robust_cost(seen, scale) + (anchor.cost(moved) if anchor else 0.0)
            slopes = corrected(slopes, step, seen - residual)
            if reached < cost:
                gain = 1.0 - reached / cost
                u, residual, cost, share = moved, seen, reached, min(1.0, 3.0 * share)
                if gain < settled:
                    break
            else:
                share /= 4.0
                if share < SHORTEST:
                    break
        if cost > (1.0 - 3.0 * settled) * before:
            break
        share = max(share, 0.25)
    assert slopes is not None
    return Descent(u, residual, slopes, robust_cost(residual, scale))


EXACT = 3e-3  # step of the differences for intervals


def differences(
    residual: Problem,
    scaling: Scaling,
    u: np.ndarray,
    fixed: Mapping[str, float],
) -> np.ndarray:
    """Central differences of the residual by the scaled parameters, (samples, parameters).

    One-sided ones bend the weak directions: with η, b_m and J_m nearly moving together, they
    halved the interval of η.  Next to a bound they end at it.
    """
    points = []
    low, high = scaling.around(u)
    widths = np.zeros(len(u))
    for k in range(len(u)):
        for sign in (1.0, -1.0):
            moved = u.copy()
            moved[k] = np.clip(u[k] + sign * EXACT, low[k], high[k])
            widths[k] += sign * moved[k]
            points.append({**fixed, **scaling.physical(moved)})
    values = residual.many(points)
    pairs = zip(values[::2], values[1::2], widths, strict=True)
    return np.column_stack([(ahead - behind) / width for ahead, behind, width in pairs])


def slopes_ahead(
    residual: Problem,
    scaling: Scaling,
    u: np.ndarray,
    fixed: Mapping[str, float],
    at: np.ndarray,
    step: float,
) -> np.ndarray:
    """One-sided differences away from the nearer bound: half the price, for the way there."""
    widths = np.where(u + step <= scaling.around(u)[1], step, -step)
    moved = [u + width * unit for width, unit in zip(widths, np.eye(len(u)), strict=True)]
    values = residual.many([{**fixed, **scaling.physical(m)} for m in moved])
    return np.column_stack([(v - at) / w for v, w in zip(values, widths, strict=True)])
