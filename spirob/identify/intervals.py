"""How sure a fit is: 95 % intervals that survive autocorrelated residuals."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from spirob.identify.scaling import Scaling
from spirob.parameter import Table


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
    """Sandwich covariance of the scaled parameters with blocks within trials as clusters.

    H = Jᵀ W J, G = Σ_b g_b g_bᵀ with g_b = J_bᵀ ψ(r_b), cov = H⁻¹ G H⁻¹ · B/(B - n)
    """
    weight = 1.0 / np.sqrt(1.0 + (residual / scale) ** 2)  # of the soft-L1 loss
    hessian = jacobian.T @ (weight[:, None] * jacobian)
    scores = []
    for start, stop in pairwise(edges):
        for k in range(start, stop, block):
            rows = slice(k, min(k + block, stop))
            scores.append(jacobian[rows].T @ (weight[rows] * residual[rows]))
    stacked = np.array(scores)
    inverse = np.linalg.pinv(hessian, rcond=1e-12)
    blocks, size = stacked.shape
    correction = blocks / max(1, blocks - size)
    return correction * inverse @ (stacked.T @ stacked) @ inverse


def estimates(
    scaling: Scaling, u: np.ndarray, covariance: np.ndarray, table: Table
) -> dict[str, Estimate]:
    """Values and intervals of a fit that ended at coordinates `u` with this covariance of them."""
    values = scaling.physical(u)
    low, high = scaling.spread(u, covariance)
    found = {}
    for k, name in enumerate(scaling.names):
        about, value = table.about[name], values[name]
        least, most = about.reach(float(table.values[table.position(name)]))
        near = 1e-3 * (most - least)
        bound = value <= least + near or value >= most - near
        if about.log:
            bound = value <= 1.005 * least or value >= 0.995 * most
        found[name] = Estimate(value, float(low[k]), float(high[k]), about.unit, bound)
    return found
