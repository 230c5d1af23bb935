"""Bounded robust least squares over parameters of the model.

p* = argmin Σ ρ((e_model(p) - e_measured)/s),   ρ(z) = 2(√(1+z²) - 1),   p in its bounds

(paper, eq. ident), e being the effort in its own unit.  It moves in the coordinates of `scaling`,
and is held by a weak anchor where the data say nothing (`descent`).  Intervals come from the
sandwich estimator with blocks of half a second as clusters, because residuals of a simulation are
autocorrelated and a plain covariance would be too narrow by a factor of several; the anchor has no
part in them.

`polished` goes the last steps, to where the data put the fit.  A search ends where its cost
settles, and is held to the data sheet as firmly as a model of a real machine deserves (`FLOOR`).
Where the residual is smaller than that, both leave the numbers that the data hold least beside
their intervals.  So a fit is finished by Gauss-Newton steps with its exact derivatives, until a
step is short against the intervals, and the anchor then weighs what the residual's own noise gives
it.  It is part of the intervals: one deviation of the data sheet is `ANCHOR` of the number.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from spirob.identify.descent import (
    Anchor,
    Descent,
    corrected,
    descend,
    differences,
    linear_step,
    robust_cost,
    slopes_ahead,
)
from spirob.identify.intervals import Estimate, block_covariance, block_scatter, estimates
from spirob.identify.problem import Problem, effort_rms
from spirob.identify.scaling import Scaling
from spirob.parameter import Table


def to_the_optimum(
    residual: Problem,
    scaling: Scaling,
    value: Callable[[np.ndarray], np.ndarray],
    start: np.ndarray,
    fixed: Mapping[str, float],
    scale: float,
    iterations: int,
    step: float,
) -> Descent:
    """By trust regions; differences of one width `step`, at most `iterations` of them."""
    slopes = np.zeros((0, 0))

    def jacobian(at: np.ndarray) -> np.ndarray:
        nonlocal slopes
        slopes = slopes_ahead(residual, scaling, at, fixed, value(at), step)
        return slopes

    found = scipy.optimize.least_squares(
        value,
        start,
        jac=jacobian,
        method="trf",
        bounds=(scaling.low, scaling.high),
        loss="soft_l1",
        f_scale=scale,
        max_nfev=iterations,
        xtol=1e-4,
        ftol=1e-4,
        gtol=None,  # a gradient has a unit, and the size of that is the machine's
    )
    u = np.asarray(found.x)
    return Descent(u, value(u), slopes, float(found.cost))


# Steps of the differences, of the scaled parameter: first wide, which looks over the ripple that
# slack and contact put on the error, and may be, because the current is nearly linear.  From three
# starts up to four times off, 0.03 ends in a valley each time, 0.1 once, 0.3 finds the truth in
# 13 to 21 evaluations.
STEPS = (0.3, 0.03)
SETTLED = 2e-3  # relative fall of the cost in a step that ends the fit: 0.1 % of the RMS
ANCHOR = 0.5  # relative width of what the data sheet says of a number, at one deviation
LOOSE = 5.0  # the same of an effect's strength: its nominal value is that of some other machine
FLOOR = 0.01  # of the effort's RMS: how well a model of a real machine may be expected to fit
INDEPENDENT = 10  # samples of the residual that say the same thing
WALKERS = 2  # of the spread starts, that walk down beside the given one
DECADE = 10.0  # an interval that wide says nothing
WORSE = 1.5  # times the cost with them: parameters that are left out were told after all


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
    slopes: np.ndarray | None = None,
) -> Fit:
    """Fit the named parameters, starting from `start` (which may hold other changes too).

    scale       s of the robust loss, in the unit of the residual: beyond it, errors count linearly
    iterations  sets of differences at most, for each of the steps
    steps       of the differences, one search with each;  exact  intervals from central
                differences at the optimum; otherwise from the last slopes of the search, for a fit
                that only has to be compared
    smooth      the residual is smooth and cheap, as an inverse model's is: walk to its very optimum
                by trust regions, from far away too, instead of stopping where the cost settles
    slopes      derivatives at the start by the coordinates of `Scaling`, where they are known
    """
    table = residual.table
    scaling = Scaling(table, names)
    fixed = {k: v for k, v in start.items() if k not in names}
    complete = {n: start.get(n, float(table.values[table.position(n)])) for n in names}
    margin = 1e-3 * (scaling.high - scaling.low) if smooth else 0.0
    u0 = np.clip(scaling.scaled(complete), scaling.low + margin, scaling.high - margin)
    known: dict[bytes, np.ndarray] = {}

    def value(u: np.ndarray) -> np.ndarray:
        if (done := known.get(u.tobytes())) is not None:
            return done
        out = residual({**fixed, **scaling.physical(u)})
        known[u.tobytes()] = out
        size = float(np.sqrt(np.mean(out**2)))
        progress(f"evaluation {len(known)}: RMS residual {residual.effort.shown(size)}")
        return out

    if smooth:
        found = to_the_optimum(residual, scaling, value, u0, fixed, scale, iterations, steps[-1])
    else:
        anchor = anchor_of(residual, scaling, start)
        for step in steps:

            def differ(u: np.ndarray, at: np.ndarray, step: float = step) -> np.ndarray:
                return slopes_ahead(residual, scaling, u, fixed, at, step)

            found = descend(
                value,
                differ,
                u0,
                scaling.around,
                scale,
                iterations,
                SETTLED,
                anchor,
                slopes,
            )
            u0, slopes = found.u, None
    jacobian = differences(residual, scaling, found.u, fixed) if exact else found.slopes
    covariance = block_covariance(jacobian, found.residual, residual.edges, scale, residual.block)
    numbers = estimates(scaling, found.u, covariance, table)
    changes = {**fixed, **scaling.physical(found.u)}
    return Fit(changes, numbers, found.residual, jacobian, found.cost, len(known))


def anchor_of(
    residual: Problem, scaling: Scaling, start: Mapping[str, float] | None = None
) -> Anchor:
    """Where the data say nothing, the data sheet does: numbers nominal, effects absent.

    start  where a fit begins: an effect's shape, of which no data sheet knows, is held there
    """
    table = residual.table
    whole = dict(zip(table.names, table.values.tolist(), strict=True))
    strengths = {n for n, v in whole.items() if v != table.about[n].nominal}
    effects = {n.split(".")[0] for n in strengths}
    shapes = {n for n in scaling.names if n.split(".")[0] in effects} - strengths
    places = {n: (start or {}).get(n, whole[n]) if n in shapes else whole[n] for n in scaling.names}
    widths = [LOOSE if n in strengths else ANCHOR for n in scaling.names]
    noise = FLOOR * effort_rms(residual) * np.sqrt(INDEPENDENT)
    return Anchor(scaling.scaled(places), np.array(widths), noise)


def best_start(
    residual: Problem,
    names: Sequence[str],
    start: Mapping[str, float],
    scale: float,
    count: int,
    seed: int = 0,
) -> dict[str, float]:
    """The best of `start` and `count` points spread around it.

    An arm whose antagonist goes slack or buckles has valleys from which no slope leads out, so a
    fit from one start is not to be trusted; nor is the point of least cost, which may lie in one.
    So `start` and the two best points walk down a little, and the lowest of them is taken.  Points
    are a scrambled Sobol set over a factor of three (half the range for numbers that do not span
    decades), cut to the bounds.
    """
    table = residual.table
    values = dict(zip(table.names, table.values.tolist(), strict=True)) | dict(start)
    spread = scipy.stats.qmc.Sobol(len(names), rng=seed).random(count) * 2.0 - 1.0
    tried = [{**start, **{n: values[n] for n in names}}]
    for point in spread:
        tried.append({**start, **_spread(table, values, names, point)})
    costs = [robust_cost(r, scale) for r in residual.many(tried)]
    chosen = [0, *(1 + np.argsort(costs[1:], kind="stable")[:WALKERS])]
    walked = [
        fit(residual, names, tried[k], scale, 1, steps=STEPS[:1], exact=False) for k in chosen
    ]
    return min(walked, key=lambda f: f.cost).changes


def _spread(
    table: Table, values: Mapping[str, float], names: Sequence[str], point: np.ndarray
) -> dict[str, float]:
    found = {}
    for name, shift in zip(names, point, strict=True):
        about, value = table.about[name], values[name]
        moved = value * 3.0**shift if about.log else value + 0.25 * (about.high - about.low) * shift
        found[name] = float(np.clip(moved, about.low, about.high))
    return found


def fit_identifiable(
    residual: Problem,
    names: Sequence[str],
    start: Mapping[str, float],
    scale: float,
    iterations: int = 20,
    progress: Callable[[str], None] = lambda text: None,
    steps: Sequence[float] = STEPS,
    exact: bool = True,
    slopes: np.ndarray | None = None,
) -> tuple[Fit, list[str]]:
    """Fit, then fit again without the parameters that the data cannot tell.

    A parameter whose interval spans a decade goes back to what the table says of it: left free it
    would drift to a bound and take the others along.  Where the fit without them is far worse the
    data tell them after all, or it lost its way (an arm that buckles): the first one stands.
    Returns the fit and the names left out.
    """
    first = fit(residual, names, start, scale, iterations, progress, steps, exact, slopes=slopes)
    vague = [
        n
        for n, e in first.estimates.items()
        if e.low > 0 and e.high / e.low > DECADE and residual.table.about[n].log
    ]
    if not vague or len(vague) == len(names):
        return first, []
    kept = [n for n in names if n not in vague]
    values = residual.table
    back = {n: float(values.values[values.position(n)]) for n in vague}
    begin = {**first.changes, **back}
    second = fit(residual, kept, begin, scale, iterations, progress, STEPS[-1:], exact)
    return (first, []) if second.cost > WORSE * first.cost else (second, vague)


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
