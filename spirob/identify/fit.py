"""Bounded robust least squares over parameters of the model.

    p* = argmin Σ ρ((e_model(p) - e_measured)/s),   ρ(z) = 2(√(1+z²) - 1),   p in its bounds

(paper, eq. ident), e being the effort in its own unit.  Parameters that span decades move
on a logarithmic scale; every one is scaled to its own size.  Intervals come from the sandwich
estimator with blocks of half a second as clusters, because residuals of a simulation are
autocorrelated and a plain covariance would be too narrow by a factor of several.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy import optimize
from scipy.stats import qmc

from spirob.identify.problem import Problem
from spirob.parameter import Table

# Steps of the differences, of the scaled parameter: first wide, which looks over the ripple that
# slack and contact put on the error (from a stiffness half the true one, a step of 0.003 or 0.01
# stays there, 0.03 finds the truth in 9 evaluations), then narrow.
STEPS = (3e-2, 3e-3)
SETTLED = 1e-3  # relative fall of the cost in a step that ends the fit: 0.05 % of the RMS
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
    residual   model minus measurement at the optimum;  jacobian  by scaled parameter
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
        self.log = np.array([a.log for a in about])
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
            return np.where(self.log, np.log(p / self._nominal), (p - self._nominal) / self._size)

    def physical(self, u: np.ndarray) -> dict[str, float]:
        """Physical values of coordinates."""
        p = np.where(self.log, self._nominal * np.exp(u), self._nominal + u * self._size)
        return {n: float(v) for n, v in zip(self.names, p, strict=True)}


def fit(
    residual: Problem,
    names: Sequence[str],
    start: Mapping[str, float],
    scale: float,
    iterations: int = 20,
    progress: Callable[[str], None] = lambda text: None,
    steps: Sequence[float] = STEPS,
    exact: bool = True,
    smooth: bool = False,
) -> Fit:
    """Fit the named parameters, starting from `start` (which may hold other changes too).

    scale       s of the robust loss, in the unit of the residual: beyond it, errors count linearly
    iterations  at most, for each of the steps
    steps       of the differences, one search with each;  exact  intervals from central
                differences at the optimum; otherwise from the last slopes of the search, for a fit
                that only has to be compared
    smooth      the residual is smooth and cheap, as an inverse model's is: walk to its very optimum
                by trust regions, from far away too, instead of stopping where the cost settles
    """
    table = residual.table
    scaling = Scaling(table, names)
    fixed = {k: v for k, v in start.items() if k not in names}
    complete = {n: start.get(n, float(table.values[table.position(n)])) for n in names}
    margin = 1e-3 * (scaling.high - scaling.low)
    u0 = np.clip(scaling.scaled(complete), scaling.low + margin, scaling.high - margin)
    known: dict[bytes, np.ndarray] = {}
    slopes = np.zeros((0, 0))

    def value(u: np.ndarray) -> np.ndarray:
        if (done := known.get(u.tobytes())) is not None:
            return done
        out = residual({**fixed, **scaling.physical(u)})
        known[u.tobytes()] = out
        size = float(np.sqrt(np.mean(out**2)))
        progress(f"evaluation {len(known)}: RMS residual {residual.effort.shown(size)}")
        return out

    def search(u: np.ndarray, step: float) -> optimize.OptimizeResult:
        def jacobian(at: np.ndarray) -> np.ndarray:
            nonlocal slopes
            slopes = _slopes(residual, scaling, at, fixed, value(at), step)
            return slopes

        return optimize.least_squares(
            value,
            u,
            jac=jacobian,
            method="trf" if smooth else "dogbox",
            x_scale=1.0 if smooth else "jac",
            bounds=(scaling.low, scaling.high),
            loss="soft_l1",
            f_scale=scale,
            max_nfev=iterations,
            xtol=1e-4,
            ftol=1e-4 if smooth else SETTLED,
            gtol=1e-10,
        )

    for step in steps:
        found = search(u0, step)
        u0 = np.asarray(found.x)
    at_optimum = value(u0)
    jacobian = differences(residual, scaling, u0, fixed) if exact else slopes
    covariance = block_covariance(jacobian, at_optimum, residual.edges, scale, residual.block)
    estimates = _estimates(scaling, u0, covariance, table)
    changes = {**fixed, **scaling.physical(u0)}
    return Fit(changes, estimates, at_optimum, jacobian, float(found.cost), len(known))


def best_start(
    residual: Problem,
    names: Sequence[str],
    start: Mapping[str, float],
    scale: float,
    count: int,
    seed: int = 0,
) -> dict[str, float]:
    """The best of `start` and `count` points spread around it, by the robust loss.

    An arm whose antagonist goes slack or buckles has valleys from which no slope leads out, so a
    fit from one start is not to be trusted.  Points are a scrambled Sobol set over a factor of
    three (half the range for numbers that are not logarithmic), cut to the bounds.
    """
    table = residual.table
    scaling = Scaling(table, names)
    values = dict(zip(table.names, table.values, strict=True)) | dict(start)
    middle = scaling.scaled(values)
    reach = np.where(scaling.log, np.log(3.0), 0.25 * (scaling.high - scaling.low))
    spread = qmc.Sobol(len(names), rng=seed).random(count) * 2.0 - 1.0
    points = [middle, *np.clip(middle + spread * reach, scaling.low, scaling.high)]
    tried = [{**start, **scaling.physical(u)} for u in points]
    costs = [float(np.sum(np.sqrt(1.0 + (r / scale) ** 2))) for r in residual.many(tried)]
    return tried[int(np.argmin(costs))]


def fit_identifiable(
    residual: Problem,
    names: Sequence[str],
    start: Mapping[str, float],
    scale: float,
    iterations: int = 20,
    progress: Callable[[str], None] = lambda text: None,
    steps: Sequence[float] = STEPS,
) -> tuple[Fit, list[str]]:
    """Fit, then fit again without the parameters that the data cannot tell.

    A parameter whose interval spans a decade goes back to its starting value: left free it would
    drift to a bound and take the others along.  Returns the fit and the names left out.
    """
    first = fit(residual, names, start, scale, iterations, progress, steps)
    vague = [
        n
        for n, e in first.estimates.items()
        if e.low > 0 and e.high / e.low > DECADE and residual.table.about[n].log
    ]
    if not vague or len(vague) == len(names):
        return first, []
    kept = [n for n in names if n not in vague]
    values = residual.table
    back = {n: start.get(n, float(values.values[values.position(n)])) for n in vague}
    begin = {**first.changes, **back}
    second = fit(residual, kept, begin, scale, iterations, progress, STEPS[-1:])
    return second, vague


def differences(
    residual: Problem,
    scaling: Scaling,
    u: np.ndarray,
    fixed: Mapping[str, float],
    step: float = STEPS[-1],
) -> np.ndarray:
    """Central differences of the residual by the scaled parameters, (samples, parameters).

    One-sided ones bend the weak directions: with η, b_m and J_m nearly moving together, they
    halved the interval of η.  Next to a bound they end at it.
    """
    points = []
    widths = np.zeros(len(u))
    for k in range(len(u)):
        for sign in (1.0, -1.0):
            moved = u.copy()
            moved[k] = np.clip(u[k] + sign * step, scaling.low[k], scaling.high[k])
            widths[k] += sign * moved[k]
            points.append({**fixed, **scaling.physical(moved)})
    values = residual.many(points)
    pairs = zip(values[::2], values[1::2], widths, strict=True)
    return np.column_stack([(ahead - behind) / width for ahead, behind, width in pairs])


def _slopes(
    residual: Problem,
    scaling: Scaling,
    u: np.ndarray,
    fixed: Mapping[str, float],
    at: np.ndarray,
    step: float,
) -> np.ndarray:
    """One-sided differences away from the nearer bound: half the price, for the way there."""
    widths = np.where(u + step <= scaling.high, step, -step)
    moved = [u + width * unit for width, unit in zip(widths, np.eye(len(u)), strict=True)]
    values = residual.many([{**fixed, **scaling.physical(m)} for m in moved])
    return np.column_stack([(v - at) / w for v, w in zip(values, widths, strict=True)])


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


def _estimates(
    scaling: Scaling, u: np.ndarray, covariance: np.ndarray, table: Table
) -> dict[str, Estimate]:
    deviation = 1.96 * np.sqrt(np.maximum(0.0, np.diag(covariance)))
    values = scaling.physical(u)
    low = scaling.physical(np.maximum(u - deviation, scaling.low))
    high = scaling.physical(np.minimum(u + deviation, scaling.high))
    near = 1e-3 * (scaling.high - scaling.low)
    bound = (u <= scaling.low + near) | (u >= scaling.high - near)
    return {
        n: Estimate(values[n], low[n], high[n], table.about[n].unit, bool(bound[k]))
        for k, n in enumerate(scaling.names)
    }
