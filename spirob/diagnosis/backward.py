"""Backward steps: what was added is questioned again.

The rung below is fitted again from where a candidate ended; an effect that is not needed beside a
later one goes; and the first of two, which was chosen without the second, may be exchanged.
"""

from collections.abc import Callable, Mapping, Sequence

from spirob.diagnosis.confirm import CLEARLY, briefly, confirm, finished, shaped
from spirob.diagnosis.evidence import complete, improvement
from spirob.diagnosis.rungs import (
    Confirmed,
    Ladder,
    Rung,
    Settings,
    label,
    line,
    parameters_of,
    rung_of,
)
from spirob.diagnosis.screen import screen
from spirob.diagnosis.weighing import counts, with_probability
from spirob.effects import Effect
from spirob.identify.fit import STEPS, fit
from spirob.identify.problem import Problem
from spirob.identify.residual import near

INSTEAD = 3  # candidates that are tried in the place of the first effect


def fitted_again(
    passed: Sequence[Confirmed],
    rung: Rung,
    close: Mapping[str, Problem],
    exact: Problem,
    settings: Settings,
    progress: Callable[[str], None],
) -> Rung | None:
    """The rung fitted again from where the best candidate's fit ended, if that is clearly better.

    An effect must not be named for having led the parameters out of a poor valley.
    """
    if not passed:
        return None
    best = min(passed, key=lambda c: float(c.errors.mean()))
    own = {n for e in best.effects for n in parameters_of(e)}
    begin = {k: v for k, v in best.fit.changes.items() if k not in own}
    names = list(rung.fit.estimates)
    again = briefly(close["train"], names, begin, settings, rung.fit.jacobian)
    if again.cost > (1.0 - CLEARLY) * rung.fit.cost:
        return None
    final = fit(
        exact,
        names,
        again.changes,
        settings.scale,
        settings.patience,
        steps=STEPS[-1:],
        exact=settings.intervals,
    )
    found = rung_of(rung.label, rung.effects, final, {**close, "train": exact})
    progress(f"the rung below, fitted again from there: {line(found.scores, exact.effort)}")
    return found


def pruned(
    search: Ladder,
    residuals: Mapping[str, Problem],
    settings: Settings,
    progress: Callable[[str], None],
    least: float | None,
) -> None:
    """Take out of the last rung what is not needed beside the latest effect.

    least  size that the latest had to have
    """
    last, train = search.rungs[-1], residuals["train"]
    for effect in last.effects[:-1]:
        rung = _less(last, effect, residuals, settings)
        if not counts(last, rung, residuals, settings, least):
            progress(f"{effect.name()} is not needed any more: {line(rung.scores, train.effort)}")
            search.rungs[-1:] = [rung]
            return


def exchanged(
    search: Ladder,
    candidates: Sequence[type[Effect]],
    residuals: Mapping[str, Problem],
    settings: Settings,
    progress: Callable[[str], None],
) -> None:
    """Another in the place of the first of two effects, where the two leave too much.

    The first was chosen while the second was missing, and may have been what imitates both best.
    """
    last, validate = search.rungs[-1], residuals["validate"]
    enough = complete(validate, settings.floor)
    if len(last.effects) != 2 or last.scores["validate"].rmse < enough:
        return
    first, second = last.effects
    train = near(residuals["train"], last.fit.changes)
    close = {**residuals, "train": train}
    below = _less(last, first, close, settings)
    others = [c for c in candidates if c not in last.effects]
    names = list(below.fit.estimates)
    ranked = screen(train, below.fit, names, others, settings.scale)
    progress(f"instead of {first.name()}: " + ", ".join(s.effect.name() for s in ranked[:INSTEAD]))
    finalists = [s for s in ranked[:INSTEAD] if s.gain > 0.0]
    tried = [confirm([s], below, close, settings, progress) for s in finalists]
    if not tried:
        return
    best = min(tried, key=lambda c: float(c.errors.mean()))
    best = shaped(best, close, settings, progress)
    if improvement(last.errors, best.errors, settings.seed)[1] <= 0.0:
        return
    best = finished(best, residuals, settings)
    effects = [second, *best.effects]
    rated = with_probability([best], below, train, settings)
    rung = Rung(f"+ {label(effects)}", effects, best.fit, best.scores, best.errors)
    search.rungs[-2:] = [below, rung]
    search.rounds[-1] = [*rated, *search.rounds[-1]]


def _less(
    last: Rung, effect: type[Effect], residuals: Mapping[str, Problem], settings: Settings
) -> Rung:
    """The rung fitted again without one of its effects."""
    rest = [e for e in last.effects if e is not effect]
    own = parameters_of(effect)
    begin = {k: v for k, v in last.fit.changes.items() if k not in own}
    names = [n for n in last.fit.estimates if n not in own]
    lesser = briefly(residuals["train"], names, begin, settings)
    return rung_of(f"+ {label(rest)}", rest, lesser, residuals)
