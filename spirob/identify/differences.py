"""Derivatives of a residual by the coordinates of a fit, from simulations beside a point."""

from collections.abc import Mapping

import numpy as np

from spirob.identify.problem import Problem
from spirob.identify.scaling import Scaling

EXACT = 3e-3  # step of the differences for intervals


def differences(
    residual: Problem,
    scaling: Scaling,
    u: np.ndarray,
    fixed: Mapping[str, float],
    step: float = EXACT,
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
            moved[k] = np.clip(u[k] + sign * step, low[k], high[k])
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
