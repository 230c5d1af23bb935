"""The last steps of a fit, to where the data put it.

A search ends where its cost settles, and is held to the data sheet as firmly as a model of a real
machine deserves (`fit.FLOOR`).  Where the residual is smaller than that, both leave the numbers
that the data hold least beside their intervals.  So a fit is finished by Gauss-Newton steps with
its exact derivatives, until a step is short against the intervals, and the anchor then weighs what
the residual's own noise gives it.  It is part of the intervals: one deviation of the data sheet is
`fit.ANCHOR` of the number.
"""

from dataclasses import replace

import numpy as np

from spirob.identify.descent import Anchor, corrected, linear_step, robust_cost
from spirob.identify.fit import Fit, anchor_of
from spirob.identify.intervals import block_scatter, estimates
from spirob.identify.problem import Problem
from spirob.identify.scaling import Scaling

MOST = 5  # steps; each costs one evaluation
SHORT = 0.1  # of a standard deviation: a step that ends it


def polished(problem: Problem, found: Fit, scale: float) -> Fit:
    """A fit with exact derivatives, taken to its optimum; `scale` is that of the robust loss."""
    scaling = Scaling(problem.table, list(found.estimates))
    fixed = {k: v for k, v in found.changes.items() if k not in found.estimates}
    held = anchor_of(problem, scaling, found.changes)
    u, residual, slopes = scaling.scaled(found.changes), found.residual, found.jacobian
    evaluations = 0
    while True:
        anchor, covariance = _weighed(problem, residual, slopes, scale, held)
        if evaluations == MOST:
            break
        low, high = scaling.around(u)
        step = linear_step(residual, slopes, (low - u, high - u), scale, anchor.rows(u))
        if np.all(np.abs(step) < SHORT * np.sqrt(np.diag(covariance))):
            break
        moved = np.clip(u + step, low, high)
        seen = problem({**fixed, **scaling.physical(moved)})
        evaluations += 1
        before = robust_cost(residual, scale) + anchor.cost(u)
        slopes = corrected(slopes, moved - u, seen - residual)
        if robust_cost(seen, scale) + anchor.cost(moved) < before:
            u, residual = moved, seen
    return Fit(
        {**fixed, **scaling.physical(u)},
        estimates(scaling, u, covariance, problem.table),
        residual,
        slopes,
        robust_cost(residual, scale),
        found.evaluations + evaluations,
    )


def _weighed(
    problem: Problem, residual: np.ndarray, slopes: np.ndarray, scale: float, held: Anchor
) -> tuple[Anchor, np.ndarray]:
    """The anchor at the noise that the residual shows, and the covariance of the anchored fit.

    cov = A⁻¹ (G + s² Λ) A⁻¹,   A = H + Λ,   Λ = diag(s/width)²,   s² = tr(H⁻¹ G)/n
    """
    hessian, scatter = block_scatter(slopes, residual, problem.edges, scale, problem.block)
    noise = float(np.sqrt(np.trace(np.linalg.pinv(hessian, rcond=1e-12) @ scatter) / len(hessian)))
    stiffness = np.eye(len(hessian)) * (noise / held.width) ** 2
    inverse = np.linalg.pinv(hessian + stiffness, rcond=1e-12)
    return replace(held, noise=noise), inverse @ (scatter + noise**2 * stiffness) @ inverse
