"""Candidates in full simulation: amplitudes, then shapes, then to the end; several at once.

Several candidates at once: the numbers to play them with, to first order.

Each candidate was fitted alone, and what that did to the residual is known; so is the derivative of
the residual by the fitted numbers.  Several together are taken as

    r = r_0 + Σ w_e·(r_e - r_0 - J·(u_e - u_0)) + J·(u - u_0),     0 ≤ w_e ≤ 1,

with the shares w and the coordinates u of the fitted numbers (see `scaling`) that cost least on the
training trials.  Only the numbers come from this sum; what they are worth, the model itself says
when it plays the trials again with them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spirob.diagnosis.rungs import (
    Confirmed,
    Rung,
    Settings,
    label,
    line,
    parameters_of,
    scores_of,
)
from spirob.diagnosis.screen import Screened, amplitudes, beside
from spirob.effects import Effect
from spirob.identify.descent import linear_step
from spirob.identify.fit import STEPS, Fit, anchor_of, fit
from spirob.identify.problem import Problem
from spirob.identify.scaling import Scaling

CLEARLY = 0.05  # relative fall of the cost that makes another fit the better one


def confirm(
    chosen: Sequence[Screened],
    rung: Rung,
    residuals: Mapping[str, Problem],
    settings: Settings,
    progress: Callable[[str], None],
) -> Confirmed:
    """Fit one candidate, or several jointly, from where the screening left it."""
    first = chosen[0]
    names, begin = list(first.names), dict(first.changes)
    for other in chosen[1:]:
        names += [n for n in other.names if n not in names]
        begin = {**other.changes, **begin}
    slopes = first.slopes if len(chosen) == 1 else None
    found = briefly(residuals["train"], names, begin, settings, slopes)
    scores, missed, errors = scores_of(found, residuals)
    effects = tuple(s.effect for s in chosen)
    progress(f"{label(effects)} added and refitted: {line(scores, residuals['train'].effort)}")
    return Confirmed(effects, first.gain, found, missed, errors, scores)


def shaped(
    found: Confirmed,
    residuals: Mapping[str, Problem],
    settings: Settings,
    progress: Callable[[str], None],
) -> Confirmed:
    """Fitted until it settles, with its shapes too: a friction that yields before it slides is one
    only in its own distance."""
    names = list(found.fit.estimates)
    train = residuals["train"]
    shapes = [n for e in found.effects for n in parameters_of(e) if n not in names]
    shapes = [n for n in shapes if n in train.table.about]
    slopes = _widened(train, found.fit, names, shapes) if shapes else found.fit.jacobian
    changed = fit(
        train,
        [*names, *shapes],
        found.fit.changes,
        settings.scale,
        settings.patience,
        steps=STEPS[-1:],
        exact=False,
        slopes=slopes,
    )
    better = refitted(found, changed, residuals)
    progress(f"{label(found.effects)} to the end: {line(better.scores, train.effort)}")
    return better


def briefly(
    train: Problem,
    names: Sequence[str],
    begin: Mapping[str, float],
    settings: Settings,
    slopes: np.ndarray | None = None,
) -> Fit:
    """A fit that only has to be compared: few sets of differences, no intervals."""
    return fit(
        train,
        names,
        begin,
        settings.scale,
        settings.iterations,
        steps=STEPS[-1:],
        exact=False,
        slopes=slopes,
    )


def _widened(
    problem: Problem, known: Fit, names: Sequence[str], further: Sequence[str]
) -> np.ndarray:
    """Derivatives where a fit ended, with those by further numbers beside them."""
    scaling = Scaling(problem.table, [*names, *further])
    values = dict(zip(problem.table.names, problem.table.values.tolist(), strict=True))
    u = scaling.scaled({**values, **known.changes})
    points, widths = beside(scaling, u, [STEPS[-1]] * len(further), known.changes)
    seen = zip(problem.many(points), widths, strict=True)
    return np.column_stack([known.jacobian, *((r - known.residual) / w for r, w in seen)])


def finished(found: Confirmed, residuals: Mapping[str, Problem], settings: Settings) -> Confirmed:
    """Fitted to the end, with intervals where they are wanted."""
    if not settings.intervals:
        return found
    train, names = residuals["train"], list(found.fit.estimates)
    final = fit(
        train, names, found.fit.changes, settings.scale, settings.patience, steps=STEPS[-1:]
    )
    return refitted(found, final, residuals)


def refitted(found: Confirmed, better: Fit, residuals: Mapping[str, Problem]) -> Confirmed:
    """The same candidate with another fit."""
    scores, missed, errors = scores_of(better, residuals)
    return replace(found, fit=better, scores=scores, missed=missed, errors=errors)


LINEAR_STEPS = 2  # of the linear problem, whose weights follow the residual


@dataclass(frozen=True)
class Alone:
    """A candidate added to the base model and fitted alone.

    changes   all numbers of that model;  residual  on the training trials
    refitted  fitted in full simulation; otherwise where the screening left it
    """

    effect: type[Effect]
    changes: dict[str, float]
    residual: np.ndarray
    refitted: bool = True


def together(
    problem: Problem, base: Fit, chosen: Sequence[Alone], scale: float
) -> dict[str, float]:
    """Numbers of the model with all the chosen effects; `problem` is that of the training trials.

    scale  of the robust loss, in the unit of the residual
    """
    table = problem.table
    scaling = Scaling(table, list(base.estimates))
    values = dict(zip(table.names, table.values.tolist(), strict=True)) | base.changes
    start = scaling.scaled(values)
    moves = [scaling.scaled({**values, **one.changes}) - start for one in chosen]
    shifts = [
        one.residual - base.residual - base.jacobian @ move
        for one, move in zip(chosen, moves, strict=True)
    ]
    slopes = np.column_stack([*shifts, base.jacobian])
    count = len(chosen)
    low = np.concatenate([np.zeros(count), scaling.low - start])
    high = np.concatenate([np.ones(count), scaling.high - start])
    anchor = anchor_of(problem, scaling)
    at = np.zeros(count + len(start))
    for _ in range(LINEAR_STEPS):
        rows, target = anchor.rows(start + at[count:])
        held = np.hstack([np.zeros((len(rows), count)), rows]), target
        there = base.residual + slopes @ at
        at = np.clip(at + linear_step(there, slopes, (low - at, high - at), scale, held), low, high)
    changes = dict(base.changes)
    for one, share in zip(chosen, at[:count], strict=True):
        changes |= _own(problem, one, float(share))
    return changes | scaling.physical(start + at[count:])


def _own(problem: Problem, one: Alone, share: float) -> dict[str, float]:
    """The candidate's own numbers with that share of its amplitudes; its shapes stay."""
    prefix, strengths = f"{one.effect.name()}.", set(amplitudes(one.effect, problem))
    found = {}
    for name, value in one.changes.items():
        if name.startswith(prefix):
            absent = float(problem.table.values[problem.table.position(name)])
            found[name] = absent + share * (value - absent) if name in strengths else value
    return found
