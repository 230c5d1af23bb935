"""Bounded robust least squares over parameters of the model.

    p* = argmin Σ ρ((i_model(p) - i_measured)/s),   ρ(z) = 2(√(1+z²) - 1),   p in its bounds

(paper, eq. ident).  Parameters that span decades move on a logarithmic scale; every one is scaled
to its own size.  Intervals come from the sandwich estimator with blocks of half a second as
clusters, because residuals of a simulation are autocorrelated and a plain covariance would be too
narrow by a factor of several.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy import optimize

from spirob.identify.residual import Residual
from spirob.parameter import Table

BLOCK = 50  # residual samples in a block: 0.5 s at 100 Hz
STEP = 1e-4  # of the scaled parameter; 1e-3 halves the interval along weak directions
DECADE = 10.0  # an interval that wide says nothing


@dataclass(frozen=True)
class Estimate:
    """One fitted number with its 95 % interval, cut to its bounds."""

    value: float
    low: float
    high: float
    unit: str
    at_bound: bool


@dataclass(frozen=True)
class Fit:
    """Result of a fit.

    changes    all parameters that differ from the table's values, for `Plant.simulate`
    estimates  the fitted ones with their intervals
    residual   model minus measurement at the optimum [A];  jacobian  by scaled parameter
    cost       Σρ·s²/2
    """

    changes: dict[str, float]
    estimates: dict[str, Estimate]
    residual: np.ndarray
    jacobian: np.ndarray
    cost: float
    evaluations: int


class Scaling:
    """Between physical values and scaled coordinates: u = ln(p/p_0), or (p - p_0)/size."""

    def __init__(self, table: Table, names: Sequence[str]):
        self.names = list(names)
        about = [table.about[name] for name in names]
        self._log = np.array([a.log for a in about])
        self._nominal = np.array([a.nominal for a in about])
        span = np.array([a.high - a.low for a in about])
        size = np.where(self._nominal != 0, np.abs(self._nominal), 0.1 * span)
        self._size = np.minimum(size, span)
        self.low = self.scaled({n: a.low for n, a in zip(names, about, strict=True)})
        self.high = self.scaled({n: a.high for n, a in zip(names, about, strict=True)})

    def scaled(self, values: Mapping[str, float]) -> np.ndarray:
        """Coordinates of physical values."""
        p = np.array([values[n] for n in self.names])
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self._log, np.log(p / self._nominal), (p - self._nominal) / self._size)

    def physical(self, u: np.ndarray) -> dict[str, float]:
        """Physical values of coordinates."""
        p = np.where(self._log, self._nominal * np.exp(u), self._nominal + u * self._size)
        return {n: float(v) for n, v in zip(self.names, p, strict=True)}


def fit(
    residual: Residual,
    names: Sequence[str],
    start: Mapping[str, float],
    scale: float,
    iterations: int = 20,
    progress: Callable[[str], None] = lambda text: None,
) -> Fit:
    """Fit the named parameters, starting from `start` (which may hold other changes too).

    scale  s of the robust loss [A]: residuals beyond it count linearly
    """
    table = residual.plant.table
    scaling = Scaling(table, names)
    fixed = {k: v for k, v in start.items() if k not in names}
    complete = {n: start.get(n, float(table.values[table.position(n)])) for n in names}
    margin = 1e-3 * (scaling.high - scaling.low)
    u0 = np.clip(scaling.scaled(complete), scaling.low + margin, scaling.high - margin)
    known: dict[bytes, np.ndarray] = {}

    def value(u: np.ndarray) -> np.ndarray:
        out = residual({**fixed, **scaling.physical(u)})
        known[u.tobytes()] = out
        progress(f"evaluation {len(known)}: RMS residual {np.sqrt(np.mean(out**2)):.4f} A")
        return out

    def jacobian(u: np.ndarray) -> np.ndarray:
        return differences(residual, scaling, u, fixed, known.get(u.tobytes()))

    found = optimize.least_squares(
        value,
        u0,
        jac=jacobian,
        bounds=(scaling.low, scaling.high),
        loss="soft_l1",
        f_scale=scale,
        max_nfev=iterations,
        xtol=1e-4,
        ftol=1e-4,
        gtol=1e-10,
    )
    return _result(residual, scaling, found, fixed, scale)


def fit_identifiable(
    residual: Residual,
    names: Sequence[str],
    start: Mapping[str, float],
    scale: float,
    iterations: int = 20,
    progress: Callable[[str], None] = lambda text: None,
) -> tuple[Fit, list[str]]:
    """Fit, then fit again without the parameters that the data cannot tell.

    A parameter whose interval spans a decade goes back to its starting value: left free it would
    drift to a bound and take the others along.  Returns the fit and the names left out.
    """
    first = fit(residual, names, start, scale, iterations, progress)
    vague = [
        n
        for n, e in first.estimates.items()
        if e.low > 0 and e.high / e.low > DECADE and residual.plant.table.about[n].log
    ]
    if not vague or len(vague) == len(names):
        return first, []
    kept = [n for n in names if n not in vague]
    values = residual.plant.table
    back = {n: start.get(n, float(values.values[values.position(n)])) for n in vague}
    second = fit(residual, kept, {**first.changes, **back}, scale, iterations, progress)
    return second, vague


def differences(
    residual: Residual,
    scaling: Scaling,
    u: np.ndarray,
    fixed: Mapping[str, float],
    at: np.ndarray | None = None,
) -> np.ndarray:
    """Derivative of the residual by the scaled parameters, (samples, parameters).

    One-sided differences, away from the nearer bound; `at` is the residual at u where it is known.
    """
    points = [{**fixed, **scaling.physical(u)}] if at is None else []
    widths = np.where(u + STEP <= scaling.high, STEP, -STEP)
    for k, width in enumerate(widths):
        moved = u.copy()
        moved[k] += width
        points.append({**fixed, **scaling.physical(moved)})
    values = residual.many(points)
    if at is None:
        at, *values = values
    return np.column_stack([(v - at) / w for v, w in zip(values, widths, strict=True)])


def block_covariance(
    jacobian: np.ndarray, residual: np.ndarray, edges: np.ndarray, scale: float
) -> np.ndarray:
    """Sandwich covariance of the scaled parameters with blocks within trials as clusters.

    H = Jᵀ W J, G = Σ_b g_b g_bᵀ with g_b = J_bᵀ ψ(r_b), cov = H⁻¹ G H⁻¹ · B/(B - n)
    """
    weight = 1.0 / np.sqrt(1.0 + (residual / scale) ** 2)  # of the soft-L1 loss
    hessian = jacobian.T @ (weight[:, None] * jacobian)
    scores = []
    for start, stop in pairwise(edges):
        for k in range(start, stop, BLOCK):
            rows = slice(k, min(k + BLOCK, stop))
            scores.append(jacobian[rows].T @ (weight[rows] * residual[rows]))
    stacked = np.array(scores)
    inverse = np.linalg.pinv(hessian, rcond=1e-12)
    blocks, size = stacked.shape
    correction = blocks / max(1, blocks - size)
    return correction * inverse @ (stacked.T @ stacked) @ inverse


def _result(
    residual: Residual,
    scaling: Scaling,
    found: optimize.OptimizeResult,
    fixed: Mapping[str, float],
    scale: float,
) -> Fit:
    u = np.asarray(found.x)
    at_optimum = residual({**fixed, **scaling.physical(u)})
    jacobian = differences(residual, scaling, u, fixed, at_optimum)
    covariance = block_covariance(jacobian, at_optimum, residual.edges, scale)
    deviation = 1.96 * np.sqrt(np.maximum(0.0, np.diag(covariance)))
    values = scaling.physical(u)
    low = scaling.physical(np.maximum(u - deviation, scaling.low))
    high = scaling.physical(np.minimum(u + deviation, scaling.high))
    near = 1e-3 * (scaling.high - scaling.low)
    bound = (u <= scaling.low + near) | (u >= scaling.high - near)
    about = residual.plant.table.about
    estimates = {
        n: Estimate(values[n], low[n], high[n], about[n].unit, bool(bound[k]))
        for k, n in enumerate(scaling.names)
    }
    changes = {**fixed, **values}
    return Fit(changes, estimates, at_optimum, jacobian, float(found.cost), int(found.nfev))
