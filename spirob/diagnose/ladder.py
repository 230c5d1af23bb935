"""The search: screen, confirm in full simulation, add the best, refit everything, repeat.

Fits use the training trials, decisions the validation trials; the held-out trials are only
reported.  A candidate is added only if the rung below, fitted again from the candidate's own
numbers, does not do as well; of candidates that do about equally well the simplest is added; where
none helps alone, pairs are tried; and once two are in, each has to be needed beside the other.
"""

from collections.abc import Callable, Mapping, Sequence
from itertools import combinations

from spirob.diagnose.backward import exchanged, fitted_again, pruned
from spirob.diagnose.confirm import confirm, finished, shaped
from spirob.diagnose.noise import complete
from spirob.diagnose.rungs import Rung, Search, Settings, label, line, rung_of
from spirob.diagnose.screen import amplitudes, screen
from spirob.diagnose.weighing import LEADERS, counts, leading, least_of, simplest, with_probability
from spirob.effects import Effect
from spirob.identify.fit import STEPS, fit, fit_identifiable
from spirob.identify.near import near
from spirob.identify.problem import Problem, effort_rms
from spirob.told import Steps

MOST = 6  # rounds, if backward steps take out what was added
PAIRED = 3  # candidates of which pairs are tried
POOR = 0.25  # of a rung's squared error, if a fit from elsewhere leaves less: another valley


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
           parameters alone, its first screening and what it fitted there are taken over, less who
           does not take part now
    """
    validate = residuals["validate"]
    for same in [c for c in candidates if set(c.stands_for) & set(names)]:
        progress(f"{same.name()} is no candidate: a fitted number does the same")
    candidates = [c for c in candidates if not set(c.stands_for) & set(names)]
    # a line for each round's screening, finalist and leader, and for what is questioned after it
    progress = Steps(progress, 1 + settings.rounds * (settings.finalists + LEADERS + 2))
    search = _known(known) if known else begun(residuals, names, start, settings)
    progress(f"parameters only: {line(search.rungs[0].scores, validate.effort)}")
    enough = complete(validate, settings.floor)
    again_from_better = False
    while len(search.rungs[-1].effects) < settings.rounds and len(search.rounds) < MOST:
        rung = search.rungs[-1]
        # a round stays near its rung; what it ends with is scored, and finished, on the trials
        train = near(residuals["train"], rung.fit.changes)
        close = {**residuals, "train": train}
        absent = [c for c in candidates if c not in rung.effects]
        error = rung.scores["validate"].rmse
        if not absent or (rung.effects and error < enough):
            break
        if not settings.always and error < settings.floor * effort_rms(validate):
            break
        seen = known if known and not (search.screened or again_from_better) else None
        if seen and _screened_here(seen):
            ranked = [s for s in seen.screened[0] if s.effect in absent]
            done = {c.effects: c for c in seen.rounds[0]}
        else:
            done = {}
            ranked = screen(train, rung.fit, _names(rung, names, train), absent, settings.scale)
        progress("screened: " + ", ".join(f"{s.effect.name()} {s.gain:+.0%}" for s in ranked[:5]))
        keep = max(1, settings.finalists - len(rung.effects))
        finalists = [s for s in ranked[:keep] if s.gain > 0.0]
        tried = [
            done.get((s.effect,)) or confirm([s], rung, close, settings, progress)
            for s in finalists
        ]
        least = least_of(search, settings)
        passed = [c for c in tried if counts(c, rung, validate, settings, least)]
        if not passed and not rung.effects and error > enough:
            pairs = combinations(finalists[:PAIRED], 2)
            joint = [confirm(pair, rung, close, settings, progress) for pair in pairs]
            passed = [c for c in joint if counts(c, rung, validate, settings)]
            tried += passed
        again = fitted_again(passed, rung, close, residuals["train"], settings, progress)
        if again is not None:
            poor = again.errors.mean() < POOR * rung.errors.mean()
            search.rungs[-1] = rung = again
            least = least_of(search, settings)
            passed = [c for c in passed if counts(c, rung, validate, settings, least)]
            if (poor or not passed) and not again_from_better:
                again_from_better = True  # the candidates were ranked in a poor valley
                continue
        leaders = [shaped(c, close, settings, progress) for c in leading(passed)]
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
        pruned(search, close, settings, progress, least)
        exchanged(search, candidates, residuals, settings, progress)
    return search


def begun(
    residuals: Mapping[str, Problem],
    names: Sequence[str],
    start: Mapping[str, float],
    settings: Settings,
    steps: Sequence[float] = STEPS,
) -> Search:
    """A search that has not looked for anything yet: the fit of the parameters alone.

    steps  of its differences; the last alone where `start` is a fit with the wide ones
    """
    train = residuals["train"]
    cheap = near(train, start)
    first = fit(cheap, names, start, settings.scale, settings.patience, steps=steps, exact=False)
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


def _screened_here(known: Search) -> bool:
    """Whether the first round began at the fit with which the search began."""
    return bool(known.screened and known.rounds) and known.rungs[0] is known.base


def _known(earlier: Search) -> Search:
    return Search(earlier.base, [earlier.base], vague=list(earlier.vague))


def _names(rung: Rung, fitted: Sequence[str], problem: Problem) -> list[str]:
    """The numbers of a rung that are fitted along: the model's, and amplitudes of its effects."""
    return [*fitted, *(n for e in rung.effects for n in amplitudes(e, problem))]
