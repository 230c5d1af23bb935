"""The search: screen, confirm in full simulation, add the best, refit everything, repeat.

Fits use the training trials, decisions the validation trials; the held-out trials are only
reported.  A candidate is added only if the rung below, fitted again from the candidate's own
numbers, does not do as well; of candidates that do about equally well the simplest is added; where
none helps alone, pairs are tried; and once two are in, each has to be needed beside the other.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from spirob.diagnose.confirm import briefly, confirm, finished, shaped
from spirob.diagnose.evidence import block_errors, foreseen, improvement, win_rates
from spirob.diagnose.noise import complete
from spirob.diagnose.rungs import (
    Confirmed,
    Rung,
    Search,
    Settings,
    label,
    line,
    parameters_of,
    rung_of,
)
from spirob.diagnose.screen import amplitudes, screen
from spirob.effects import Effect
from spirob.identify.fit import INDEPENDENT, STEPS, Fit, fit, fit_identifiable
from spirob.identify.near import near
from spirob.identify.problem import Problem, effort_rms

CLEARLY = 0.05  # relative fall of the cost that makes another fit the better one
LEADERS = 2  # candidates fitted until they settle, with their shapes too
REACH = 4.0  # times the least mean square: who missed more is fitted no further
PAIRED = 3  # candidates of which pairs are tried


def climb(
    residuals: Mapping[str, Problem],
    names: Sequence[str],
    candidates: Sequence[type[Effect]],
    start: Mapping[str, float],
    settings: Settings,
    progress: Callable[[str], None] = lambda text: None,
    known: Search | None = None,
) -> Search:
    """Search for missing effects; residuals by role share one plant that holds all candidates.

    names  parameters fitted at every rung;  start  where their fit begins.  What the data do not
           tell without an effect stays at its place on the first rung only: with the effect that
           is missing it may well be told
    known  an earlier search of the same trials, begun or among more candidates: its fit of the
           parameters alone and its first screening are taken over, less who does not take part now
    """
    validate = residuals["validate"]
    search = _known(known) if known else begun(residuals, names, start, settings)
    progress(f"parameters only: {line(search.rungs[0].scores, validate.effort)}")
    rest = complete(validate, settings.rest)
    while len(search.rungs[-1].effects) < settings.rounds:
        rung = search.rungs[-1]
        # a round stays near its rung; what it ends with is scored, and finished, on the trials
        train = near(residuals["train"], rung.fit.changes)
        close = {**residuals, "train": train}
        absent = [c for c in candidates if c not in rung.effects]
        error = rung.scores["validate"].rmse
        if not absent or (rung.effects and error < rest):
            break
        if not settings.always and error < settings.floor * effort_rms(validate):
            break
        if known and known.screened and not search.screened:
            ranked = [s for s in known.screened[0] if s.effect in absent]
        else:
            ranked = screen(train, rung.fit, _names(rung, names, train), absent, settings.scale)
        progress("screened: " + ", ".join(f"{s.effect.name()} {s.gain:+.0%}" for s in ranked[:5]))
        keep = max(1, settings.finalists - len(rung.effects))
        finalists = [s for s in ranked[:keep] if s.gain > 0.0]
        tried = [confirm([s], rung, close, settings, progress) for s in finalists]
        passed = [c for c in tried if counts(c, rung, validate, settings, _least(search, settings))]
        if not passed and not rung.effects and rung.scores["validate"].rmse > rest:
            pairs = combinations(finalists[:PAIRED], 2)
            joint = [confirm(pair, rung, close, settings, progress) for pair in pairs]
            passed = [c for c in joint if counts(c, rung, validate, settings)]
            tried += passed
        again = _without(passed, rung, close, residuals["train"], settings, progress)
        if again is not None:
            search.rungs[-1] = rung = again
            least = _least(search, settings)
            passed = [c for c in passed if counts(c, rung, validate, settings, least)]
        leaders = [shaped(c, close, settings, progress) for c in _leading(passed)]
        improved = {c.effects: c for c in leaders}
        tried = [improved.get(c.effects, c) for c in tried]
        search.screened.append(ranked)
        search.rounds.append(with_probability(tried, rung, train, settings))
        if not leaders:
            break
        best = finished(simplest(leaders, settings), residuals, settings)
        effects = [*rung.effects, *best.effects]
        grown = Rung(f"+ {label(effects)}", effects, best.fit, best.scores, best.errors)
        search.rungs.append(grown)
        _pruned(search, close, settings, progress)
    return search


def _leading(passed: Sequence[Confirmed]) -> list[Confirmed]:
    """The best, and the next if it is within reach."""
    ranked = sorted(passed, key=lambda c: float(c.errors.mean()))
    return [c for c in ranked[:LEADERS] if c.errors.mean() <= REACH * ranked[0].errors.mean()]


def begun(
    residuals: Mapping[str, Problem],
    names: Sequence[str],
    start: Mapping[str, float],
    settings: Settings,
) -> Search:
    """A search that has not looked for anything yet: the fit of the parameters alone."""
    train = residuals["train"]
    cheap = near(train, start)
    first = fit(cheap, names, start, settings.scale, settings.patience, exact=False)
    found, vague = fit_identifiable(
        train,
        names,
        first.changes,
        settings.scale,
        settings.patience,
        steps=STEPS[-1:],
        exact=settings.intervals,
        slopes=first.jacobian,
    )
    base = rung_of("fitted parameters", [], found, residuals)
    return Search(base, [base], vague=vague)


def _known(earlier: Search) -> Search:
    return Search(earlier.base, [earlier.base], vague=list(earlier.vague))


def _names(rung: Rung, fitted: Sequence[str], problem: Problem) -> list[str]:
    """The numbers of a rung that are fitted along: the model's, and amplitudes of its effects."""
    return [*fitted, *(n for e in rung.effects for n in amplitudes(e, problem))]


def _without(
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


def _pruned(
    search: Search,
    residuals: Mapping[str, Problem],
    settings: Settings,
    progress: Callable[[str], None],
) -> None:
    """Take out of the last rung what is not needed beside the latest effect."""
    last, train = search.rungs[-1], residuals["train"]
    for effect in last.effects[:-1]:
        rest = [e for e in last.effects if e is not effect]
        own = parameters_of(effect)
        begin = {k: v for k, v in last.fit.changes.items() if k not in own}
        names = [n for n in last.fit.estimates if n not in own]
        lesser = briefly(train, names, begin, settings)
        rung = rung_of(f"+ {label(rest)}", rest, lesser, residuals)
        if not _matters(rung.errors, last.errors, residuals["validate"], settings):
            progress(f"{effect.name()} is not needed any more: {line(rung.scores, train.effort)}")
            search.rungs[-1:] = [rung]
            return


def counts(
    found: Confirmed, rung: Rung, validate: Problem, settings: Settings, least: float = 0.0
) -> bool:
    """Whether a candidate is large enough to matter and surely better than the rung below it.

    least  size in the unit of the effort that it has to have besides
    """
    return _matters(rung.errors, found.errors, validate, settings, least)


def _matters(
    before: np.ndarray,
    after: np.ndarray,
    validate: Problem,
    settings: Settings,
    least: float = 0.0,
) -> bool:
    size = _size(before, after)
    if size < max(settings.floor * effort_rms(validate), least):
        return False
    return improvement(before, after, settings.seed)[1] > 0.0


def _size(before: np.ndarray, after: np.ndarray) -> float:
    """√(MSE before - MSE after)."""
    return float(np.sqrt(max(0.0, float(before.mean() - after.mean()))))


def _least(search: Search, settings: Settings) -> float:
    """The least size of a further effect."""
    if len(search.rungs) == 1:
        return 0.0
    return settings.further * _size(search.rungs[0].errors, search.rungs[1].errors)


def simplest(leaders: Sequence[Confirmed], settings: Settings) -> Confirmed:
    """The best, or one with fewer numbers that is not surely worse."""
    best = min(leaders, key=lambda c: float(c.errors.mean()))
    equal = [
        c
        for c in leaders
        if c is best or improvement(c.errors, best.errors, settings.seed)[1] <= 0.0
    ]
    return min(equal, key=lambda c: (len(c.fit.estimates), float(c.errors.mean())))


def with_probability(
    confirmed: Sequence[Confirmed], rung: Rung, train: Problem, settings: Settings
) -> list[Confirmed]:
    """With the share of resampled errors that each wins; the one to add first."""
    if not confirmed:
        return []
    errors = {label(c.effects): _all_errors(c.errors, c.fit, train) for c in confirmed}
    rates = win_rates(errors | {"": _all_errors(rung.errors, rung.fit, train)}, settings.seed)
    rated = [replace(c, probability=rates[label(c.effects)]) for c in confirmed]
    return sorted(rated, key=lambda c: float(c.errors.mean()))


def _all_errors(validated: np.ndarray, found: Fit, train: Problem) -> np.ndarray:
    """Block errors on the validation trials, then on the fitted ones as if they were new."""
    missed = found.residual / np.sqrt(np.mean(train.rows))
    errors = block_errors(missed, train.edges, train.block)
    samples = len(missed) // INDEPENDENT
    return np.concatenate([validated, foreseen(errors, len(found.estimates), samples)])
