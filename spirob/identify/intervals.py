"""How sure a fit is: 95 % intervals that survive autocorrelated residuals."""

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from spirob.identify.scaling import Scaling
from spirob.parameter import Table

if TYPE_CHECKING:
    from spirob.identify.fit import Fit
    from spirob.identify.problem import Problem

ALONE = 1e-6  # keeps a block that alone tells of a number from dividing by zero


@dataclass(frozen=True)
class Estimate:
    """One fitted number with its 95 % interval, cut to its bounds."""

    value: float
    low: float
    high: float
    unit: str
    at_bound: bool


def block_covariance(
    jacobian: np.ndarray, residual: np.ndarray, edges: np.ndarray, scale: float, block: int
) -> np.ndarray:
    """Sandwich covariance H⁻¹ G H⁻¹ of the scaled parameters, blocks within trials as clusters."""
    hessian, scatter = block_scatter(jacobian, residual, edges, scale, block)
    inverse = np.linalg.pinv(hessian, rcond=1e-12)
    return np.asarray(inverse @ scatter @ inverse)


def block_scatter(
    jacobian: np.ndarray, residual: np.ndarray, edges: np.ndarray, scale: float, block: int
) -> tuple[np.ndarray, np.ndarray]:
    """H = Jᵀ W J and G = (B - 1)/B Σ_b g_b g_bᵀ, (n, n) each.

    g_b = (1 - H_b H⁻¹)⁻¹ J_bᵀ ψ(r_b) is what leaving block b out would change: a fit bends towards
    each block, the more the fewer there are, and its own residual tells too little of the noise
    (Bell, McCaffrey, Survey Methodology 28, 2002: CR3).  With B/(B - n) instead, 32 blocks of half
    a second and 7 numbers, 89 to 94 % of the true values lay in their intervals; with this, 94 to
    97 %.  What one block alone tells has no interval: its number is as good as unknown.
    """
    weight = 1.0 / np.sqrt(1.0 + (residual / scale) ** 2)  # of the soft-L1 loss
    hessian = jacobian.T @ (weight[:, None] * jacobian)
    inverse = np.linalg.pinv(hessian, rcond=1e-12)
    whole = (1.0 + ALONE) * np.eye(len(hessian))
    scores = []
    for start, stop in pairwise(edges):
        for k in range(start, stop, block):
            rows = slice(k, min(k + block, stop))
            weighted = weight[rows, None] * jacobian[rows]
            share = weighted.T @ jacobian[rows] @ inverse
            scores.append(np.linalg.solve(whole - share, weighted.T @ residual[rows]))
    stacked = np.array(scores)
    return hessian, (1.0 - 1.0 / len(stacked)) * stacked.T @ stacked


def covariance_of(problem: "Problem", found: "Fit", scale: float) -> list[list[float]] | None:
    """Covariance of the fitted numbers in their own units, (n, n) in the order of `estimates`.

    To first order where the fit ended; scale  of its robust loss.  None where the data leave some
    number so open that it has none.
    """
    scaling = Scaling(problem.table, list(found.estimates))
    u = scaling.scaled({name: e.value for name, e in found.estimates.items()})
    own = block_covariance(found.jacobian, found.residual, problem.edges, scale, problem.block)
    slopes = scaling.slopes(u)
    covariance = slopes @ own @ slopes.T
    return covariance.tolist() if np.all(np.isfinite(covariance)) else None


def estimates(
    scaling: Scaling, u: np.ndarray, covariance: np.ndarray, table: Table
) -> dict[str, Estimate]:
    """Values and intervals of a fit that ended at coordinates `u` with this covariance of them."""
    values = scaling.physical(u)
    low, high = scaling.spread(u, covariance)
    found = {}
    for k, name in enumerate(scaling.names):
        about, value = table.about[name], values[name]
        bound = about.at_bound(value, float(table.values[table.position(name)]))
        found[name] = Estimate(value, float(low[k]), float(high[k]), about.unit, bound)
    return found
