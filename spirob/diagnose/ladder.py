"""The search: screen, confirm in full simulation, add the best, refit everything, repeat.

Fits use the training trials, decisions the validation trials; the held-out trials are only
reported.  A candidate is added only if the rung below, fitted again from the candidate's own
numbers, does not do as well; of candidates that do about equally well the simplest is added; where
none helps alone, pairs are tried; and once two are in, each has to be needed beside the other.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np

from spirob.diagnose.evidence import block_errors, improvement, win_rates
from spirob.diagnose.screen import Screened, amplitudes, screen
from spirob.effects import Effect
from spirob.effects.individual import differences
from spirob.identify.fit import STEPS, Fit, fit, fit_identifiable
from spirob.identify.problem import Effort, Problem, effort_rms
from spirob.score import Score, score

ROLES = ("train", "validate", "heldout")
CLEARLY = 0.05  # relative fall of the cost that makes another fit the better one
LEADERS = 2  # candidates fitted with their shapes too
PAIRED = 3  # candidates of which pairs are tried
REST = 2.0  # floors: an error below that is not searched any further


@dataclass(frozen=True)
class Settings:
    """How the search decides.

    scale        of the robust loss, in the unit of the effort
    finalists    candidates confirmed in full simulation in the first round; one less in each after
    rounds       effects added at most
    floor        smallest effect that counts: √(MSE before - MSE after) over the RMS effort
    further      least size of a second effect, relative to the first: a law of the library is never
                 quite that of the machine, and what is left of its form is no effect of its own
    confidence   an effect is named when it wins this share of resampled validation errors
    explained    least share of the squared error above the floor that named effects account for;
                 with less, something else is missing
    iterations   sets of differences in the fit of a finalist
    patience     sets of differences in a last fit, and in the fit of the parameters alone
    """

    scale: float = 0.05
    finalists: int = 4
    rounds: int = 2
    floor: float = 0.008
    further: float = 0.25
    confidence: float = 0.9
    explained: float = 0.5
    iterations: int = 2
    patience: int = 6
    seed: int = 0


@dataclass(frozen=True)
class Confirmed:
    """Candidates after a full refit; errors are mean squares by block on validation trials.

    effects  one, or a pair that helps only jointly
    """

    effects: tuple[type[Effect], ...]
    gain: float
    fit: Fit
    errors: np.ndarray
    scores: dict[str, Score]
    probability: float = 0.0


@dataclass(frozen=True)
class Rung:
    """One step of the ladder."""

    label: str
    effects: list[type[Effect]]
    fit: Fit
    scores: dict[str, Score]
    errors: np.ndarray


@dataclass
class Search:
    """Everything that the search saw; rounds[k] are the finalists of round k, best first."""

    rungs: list[Rung]
    rounds: list[list[Confirmed]] = field(default_factory=list)
    screened: list[list[Screened]] = field(default_factory=list)
    vague: list[str] = field(default_factory=list)


def climb(
    residuals: Mapping[str, Problem],
    names: Sequence[str],
    candidates: Sequence[type[Effect]],
    start: Mapping[str, float],
    settings: Settings,
    progress: Callable[[str], None] = lambda text: None,
) -> Search:
    """Search for missing effects; residuals by role share one plant that holds all candidates.

    names  parameters fitted at every rung;  start  where their fit begins
    """
    train, validate = residuals["train"], residuals["validate"]
    base, vague = fit_identifiable(
        train, names, start, settings.scale, settings.patience, steps=STEPS[:1]
    )
    fitted = [n for n in names if n not in vague]
    search = Search([_rung("fitted parameters", [], base, residuals)], vague=vague)
    progress(f"parameters only: {_line(search.rungs[0].scores, train.effort)}")
    floor = REST * settings.floor * effort_rms(validate)
    while len(search.rungs[-1].effects) < settings.rounds:
        rung = search.rungs[-1]
        absent = [c for c in candidates if c not in rung.effects]
        if not absent or (rung.effects and rung.scores["validate"].rmse < floor):
            break
        ranked = screen(train, rung.fit, _names(rung, fitted, train), absent, settings.scale)
        progress("screened: " + ", ".join(f"{s.effect.name()} {s.gain:+.0%}" for s in ranked[:5]))
        keep = max(1, settings.finalists - len(rung.effects))
        finalists = [s for s in ranked[:keep] if s.gain > 0.0]
        tried = [_confirm([s], rung, residuals, settings, progress) for s in finalists]
        passed = [c for c in tried if counts(c, rung, validate, settings, _least(search, settings))]
        if not passed and not rung.effects and rung.scores["validate"].rmse > floor:
            pairs = combinations(finalists[:PAIRED], 2)
            joint = [_confirm(pair, rung, residuals, settings, progress) for pair in pairs]
            passed = [c for c in joint if counts(c, rung, validate, settings)]
            tried += passed
        again = _without(passed, rung, residuals, settings, progress)
        if again is not None:
            search.rungs[-1] = rung = again
            least = _least(search, settings)
            passed = [c for c in passed if counts(c, rung, validate, settings, least)]
        leaders = [
            _shaped(c, residuals, settings, progress)
            for c in sorted(passed, key=lambda c: float(c.errors.mean()))[:LEADERS]
        ]
        shaped = {c.effects: c for c in leaders}
        tried = [shaped.get(c.effects, c) for c in tried]
        search.screened.append(ranked)
        search.rounds.append(_with_probability(tried, rung, settings))
        if not leaders:
            break
        best = _finished(_simplest(leaders, validate, settings), residuals, settings)
        effects = [*rung.effects, *best.effects]
        grown = Rung(f"+ {label(effects)}", effects, best.fit, best.scores, best.errors)
        search.rungs.append(grown)
        _pruned(search, residuals, settings, progress)
    return search


def _names(rung: Rung, fitted: Sequence[str], problem: Problem) -> list[str]:
    """The numbers of a rung that are fitted along: the model's, and amplitudes of its effects."""
    return [*fitted, *(n for e in rung.effects for n in amplitudes(e, problem))]


def _without(
    passed: Sequence[Confirmed],
    rung: Rung,
    residuals: Mapping[str, Problem],
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
    train, names = residuals["train"], list(rung.fit.estimates)
    again = fit(
        train, names, begin, settings.scale, settings.iterations, steps=STEPS[:1], exact=False
    )
    if again.cost > (1.0 - CLEARLY) * rung.fit.cost:
        return None
    final = fit(train, names, again.changes, settings.scale, settings.patience, steps=STEPS[:1])
    found = _rung(rung.label, rung.effects, final, residuals)
    progress(f"the rung below, fitted again from there: {_line(found.scores, train.effort)}")
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
        lesser = fit(
            train, names, begin, settings.scale, settings.iterations, steps=STEPS[:1], exact=False
        )
        rung = _rung(f"+ {label(rest)}", rest, lesser, residuals)
        if not _matters(rung.errors, last.errors, residuals["validate"], settings):
            progress(f"{effect.name()} is not needed any more: {_line(rung.scores, train.effort)}")
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


def parameters_of(effect: type[Effect]) -> list[str]:
    """Full names of an effect's numbers, its motors' differences included."""
    return [f"{effect.name()}.{f}" for f in [*effect.parameters(), *differences(effect)]]


def _confirm(
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
    scores, errors = _scores(found, residuals)
    effects = tuple(s.effect for s in chosen)
    progress(f"{label(effects)} added and refitted: {_line(scores, residuals['train'].effort)}")
    return Confirmed(effects, first.gain, found, errors, scores)


def _shaped(
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
    scores, errors = _scores(changed, residuals)
    progress(f"{label(found.effects)} with its shape: {_line(scores, train.effort)}")
    return replace(found, fit=changed, scores=scores, errors=errors)


def _simplest(leaders: Sequence[Confirmed], validate: Problem, settings: Settings) -> Confirmed:
    """The best, or one with fewer numbers that is not clearly worse."""
    best = min(leaders, key=lambda c: float(c.errors.mean()))
    equal = [
        c for c in leaders if c is best or not _matters(c.errors, best.errors, validate, settings)
    ]
    return min(equal, key=lambda c: (len(c.fit.estimates), float(c.errors.mean())))


def _finished(found: Confirmed, residuals: Mapping[str, Problem], settings: Settings) -> Confirmed:
    """Fitted to the end, with intervals."""
    train, names = residuals["train"], list(found.fit.estimates)
    final = fit(
        train, names, found.fit.changes, settings.scale, settings.patience, steps=STEPS[-1:]
    )
    scores, errors = _scores(final, residuals)
    return replace(found, fit=final, scores=scores, errors=errors)


def _with_probability(
    confirmed: Sequence[Confirmed], rung: Rung, settings: Settings
) -> list[Confirmed]:
    """With the share of resampled validation errors that each wins; the one to add first."""
    if not confirmed:
        return []
    errors = {label(c.effects): c.errors for c in confirmed} | {"": rung.errors}
    rates = win_rates(errors, settings.seed)
    rated = [replace(c, probability=rates[label(c.effects)]) for c in confirmed]
    return sorted(rated, key=lambda c: float(c.errors.mean()))


def label(effects: Sequence[type[Effect]]) -> str:
    """Names of effects, "a + b"."""
    return " + ".join(e.name() for e in effects)


def _rung(
    title: str, effects: list[type[Effect]], found: Fit, residuals: Mapping[str, Problem]
) -> Rung:
    scores, errors = _scores(found, residuals)
    return Rung(title, effects, found, scores, errors)


def _scores(found: Fit, residuals: Mapping[str, Problem]) -> tuple[dict[str, Score], np.ndarray]:
    scores = {}
    errors = np.zeros(0)
    for role in ROLES:
        residual = residuals[role]
        values = found.residual if role == "train" else residual(found.changes)
        measured = residual.measured()[residual.rows]
        scores[role] = score(measured, measured + values[residual.rows])
        if role == "validate":
            errors = block_errors(values, residual.edges, residual.block)
    return scores, errors


def _line(scores: Mapping[str, Score], effort: Effort) -> str:
    return ", ".join(f"{role} RMSE {effort.shown(s.rmse)}" for role, s in scores.items())
