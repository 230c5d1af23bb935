"""A candidate in full simulation: its amplitudes, then its shapes, then to the end."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from spirob.diagnose.rungs import (
    Confirmed,
    Rung,
    Settings,
    label,
    line,
    parameters_of,
    scores_of,
)
from spirob.diagnose.screen import Screened
from spirob.identify.fit import STEPS, fit
from spirob.identify.problem import Problem


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
    found = fit(
        residuals["train"],
        names,
        begin,
        settings.scale,
        settings.iterations,
        steps=STEPS[:1],
        exact=False,
        slopes=slopes,
    )
    scores, errors = scores_of(found, residuals)
    effects = tuple(s.effect for s in chosen)
    progress(f"{label(effects)} added and refitted: {line(scores, residuals['train'].effort)}")
    return Confirmed(effects, first.gain, found, errors, scores)


def shaped(
    found: Confirmed,
    residuals: Mapping[str, Problem],
    settings: Settings,
    progress: Callable[[str], None],
) -> Confirmed:
    """Fitted with its shapes too: a friction that yields before it slides is one only in its own
    distance."""
    names = list(found.fit.estimates)
    train = residuals["train"]
    shapes = [n for e in found.effects for n in parameters_of(e) if n not in names]
    shapes = [n for n in shapes if n in train.table.about]
    if not shapes:
        return found
    changed = fit(
        train,
        [*names, *shapes],
        found.fit.changes,
        settings.scale,
        settings.iterations,
        steps=STEPS[:1],
        exact=False,
    )
    scores, errors = scores_of(changed, residuals)
    progress(f"{label(found.effects)} with its shape: {line(scores, train.effort)}")
    return replace(found, fit=changed, scores=scores, errors=errors)


def finished(found: Confirmed, residuals: Mapping[str, Problem], settings: Settings) -> Confirmed:
    """Fitted to the end, with intervals."""
    train, names = residuals["train"], list(found.fit.estimates)
    final = fit(
        train,
        names,
        found.fit.changes,
        settings.scale,
        settings.patience,
        steps=STEPS[-1:],
        exact=settings.intervals,
    )
    scores, errors = scores_of(final, residuals)
    return replace(found, fit=final, scores=scores, errors=errors)
