"""A candidate in full simulation: its amplitudes, then its shapes, then to the end."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

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
from spirob.diagnosis.screen import Screened, beside
from spirob.identify.fit import STEPS, Fit, fit
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
