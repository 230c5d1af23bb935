"""The search: screen, confirm in full simulation, add the best, refit everything, repeat.

Fits use the training trials, decisions the validation trials; the held-out trials are only
reported.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from spirob.diagnose.evidence import block_errors, improvement, win_rates
from spirob.diagnose.screen import Screened, screen
from spirob.effects import Effect
from spirob.identify.fit import STEPS, Fit, fit, fit_identifiable
from spirob.identify.problem import Effort, Problem
from spirob.score import Score, score

ROLES = ("train", "validate", "heldout")
RESTARTS = 2  # times that a rung may be fitted again from a candidate's numbers
CLEARLY = 0.05  # relative fall of the cost that makes such a fit the better one


@dataclass(frozen=True)
class Settings:
    """How the search decides.

    scale        of the robust loss, in the unit of the effort
    finalists    candidates confirmed in full simulation in the first round; one less in each after
    rounds       effects added at most
    floor        smallest effect that counts: √(MSE before - MSE after) over the RMS effort
    confidence   an effect is named when it wins this share of resampled validation errors
    iterations   of the fit of a finalist; the winner is then fitted to the end
    patience     iterations of such a last fit, and of the fit of the parameters alone
    """

    scale: float = 0.05
    finalists: int = 3
    rounds: int = 2
    floor: float = 0.025
    confidence: float = 0.9
    iterations: int = 5
    patience: int = 15
    seed: int = 0


@dataclass(frozen=True)
class Confirmed:
    """A candidate after a full refit; errors are mean squares by block on validation trials."""

    effect: type[Effect]
    screened: Screened
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
    train = residuals["train"]
    base, vague = fit_identifiable(train, names, start, settings.scale, settings.patience)
    fitted = [n for n in names if n not in vague]
    search = Search([_rung("fitted parameters", [], base, residuals)], vague=vague)
    progress(f"parameters only: {_line(search.rungs[0].scores, train.effort)}")
    restarts = 0
    while len(search.rungs) <= settings.rounds:
        rung = search.rungs[-1]
        absent = [c for c in candidates if c not in rung.effects]
        if not absent:
            break
        ranked = screen(train, rung.fit.residual, rung.fit.jacobian, rung.fit.changes, absent)
        progress("screened: " + ", ".join(f"{s.effect.name()} {s.gain:+.0%}" for s in ranked[:5]))
        keep = max(1, settings.finalists - len(rung.effects))
        finalists = [s for s in ranked[:keep] if s.gain > 0.0]
        confirmed = [_confirm(s, rung, fitted, residuals, settings, progress) for s in finalists]
        confirmed = _with_probability(confirmed, rung, settings.seed)
        passed = bool(confirmed) and counts(confirmed[0], rung, residuals["validate"], settings)
        if passed and restarts < RESTARTS:
            again = _without(confirmed[0], rung, residuals, settings)
            if again is not None:
                restarts += 1
                search.rungs[-1] = again
                progress(
                    f"the rung below, fitted again from there: {_line(again.scores, train.effort)}"
                )
                continue
        search.screened.append(ranked)
        search.rounds.append(confirmed)
        if not passed:
            break
        best = _polished(confirmed[0], residuals, settings)
        label = " + ".join(e.name() for e in [*rung.effects, best.effect])
        search.rungs.append(
            Rung(f"+ {label}", [*rung.effects, best.effect], best.fit, best.scores, best.errors)
        )
    return search


def _without(
    found: Confirmed, rung: Rung, residuals: Mapping[str, Problem], settings: Settings
) -> Rung | None:
    """The rung fitted again from where the candidate's fit ended, if that is clearly better.

    An effect must not be named for having led the parameters out of a poor valley.
    """
    own = parameters_of(found.effect)
    begin = {k: v for k, v in found.fit.changes.items() if k not in own}
    names = list(rung.fit.estimates)
    train = residuals["train"]
    few, first = settings.iterations, STEPS[:1]
    again = fit(train, names, begin, settings.scale, few, steps=first, exact=False)
    if again.cost > (1.0 - CLEARLY) * rung.fit.cost:
        return None
    limit = settings.patience
    final = fit(train, names, again.changes, settings.scale, limit, steps=STEPS[-1:])
    return _rung(rung.label, rung.effects, final, residuals)


def counts(found: Confirmed, rung: Rung, validate: Problem, settings: Settings) -> bool:
    """Whether a candidate is large enough to matter and surely better than the rung below it."""
    fall = float(rung.errors.mean() - found.errors.mean())
    size = np.sqrt(max(0.0, fall)) / float(np.sqrt(np.mean(validate.measured() ** 2)))
    _, low, _ = improvement(rung.errors, found.errors, settings.seed)
    return bool(size >= settings.floor and low > 0.0)


def parameters_of(effect: type[Effect]) -> list[str]:
    """Full names of an effect's numbers."""
    return [f"{effect.name()}.{f}" for f in effect.parameters()]


def _confirm(
    screened: Screened,
    rung: Rung,
    fitted: Sequence[str],
    residuals: Mapping[str, Problem],
    settings: Settings,
    progress: Callable[[str], None],
) -> Confirmed:
    effect = screened.effect
    begin = dict(rung.fit.changes)
    for name, about in effect.parameters().items():
        begin[f"{effect.name()}.{name}"] = screened.amplitudes.get(name, about.nominal)
    names = [*fitted, *(n for e in [*rung.effects, effect] for n in parameters_of(e))]
    found = fit(
        residuals["train"],
        names,
        begin,
        settings.scale,
        settings.iterations,
        steps=STEPS[:1],
        exact=False,
    )
    scores, errors = _scores(found, residuals)
    progress(f"{effect.name()} added and refitted: {_line(scores, residuals['train'].effort)}")
    return Confirmed(effect, screened, found, errors, scores)


def _polished(found: Confirmed, residuals: Mapping[str, Problem], settings: Settings) -> Confirmed:
    names = list(found.fit.estimates)
    begin, limit = found.fit.changes, settings.patience
    final = fit(residuals["train"], names, begin, settings.scale, limit, steps=STEPS[-1:])
    scores, errors = _scores(final, residuals)
    return replace(found, fit=final, scores=scores, errors=errors)


def _with_probability(confirmed: list[Confirmed], rung: Rung, seed: int) -> list[Confirmed]:
    if not confirmed:
        return []
    errors = {c.effect.name(): c.errors for c in confirmed} | {"": rung.errors}
    rates = win_rates(errors, seed)
    rated = [replace(c, probability=rates[c.effect.name()]) for c in confirmed]
    return sorted(rated, key=lambda c: float(c.errors.mean()))


def _rung(
    label: str, effects: list[type[Effect]], found: Fit, residuals: Mapping[str, Problem]
) -> Rung:
    scores, errors = _scores(found, residuals)
    return Rung(label, effects, found, scores, errors)


def _scores(found: Fit, residuals: Mapping[str, Problem]) -> tuple[dict[str, Score], np.ndarray]:
    scores = {}
    errors = np.zeros(0)
    for role in ROLES:
        residual = residuals[role]
        values = found.residual if role == "train" else residual(found.changes)
        measured = residual.measured()
        scores[role] = score(measured, measured + values)
        if role == "validate":
            errors = block_errors(values, residual.edges, residual.block)
    return scores, errors


def _line(scores: Mapping[str, Score], effort: Effort) -> str:
    return ", ".join(f"{role} RMSE {effort.shown(s.rmse)}" for role, s in scores.items())
