"""The search: screen, confirm in full simulation, add the best, refit everything, repeat.

Fits use the training trials, decisions the validation trials; the held-out trials are only
reported.  A candidate is added only if the rung below, fitted again from the candidate's own
numbers, does not do as well; of candidates that do about equally well the simplest is added; where
none helps alone, pairs are tried; and once two are in, each has to be needed beside the other.

One round of the search after another: screen, confirm in full simulation, add the best.

A candidate counts only if the rung below, fitted again from the candidate's own numbers, does not
do as well; of candidates that do about equally well the simplest is added; where none helps alone,
pairs are tried.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from spirob.diagnosis.backward import exchanged, fitted_again, pruned, to_the_end
from spirob.diagnosis.certainty import LIKELY
from spirob.diagnosis.confirm import CLEARLY, confirm, finished
from spirob.diagnosis.evidence import complete
from spirob.diagnosis.figures import weighed
from spirob.diagnosis.rungs import Confirmed, Ladder, Rung, Settings, label, line, rung_of
from spirob.diagnosis.screen import Screened, amplitudes, screen
from spirob.diagnosis.weighing import (
    LEADERS,
    counts,
    leading,
    least_of,
    periodic,
    rms,
    simplest,
    with_probability,
)
from spirob.effects import Effect
from spirob.identify.builds import RESOLUTION, Floor
from spirob.identify.fit import STEPS, Fit, fit, fit_identifiable
from spirob.identify.problem import Problem, effort_rms
from spirob.identify.residual import near
from spirob.identify.scaling import Scaling
from spirob.progress import Steps

MOST = 6  # rounds, if backward steps take out what was added
PAIRED = 3  # candidates of which pairs are tried
Measure = Callable[[Fit], Floor]
POOR = 0.25  # of a rung's squared error, if a fit from elsewhere leaves less: another valley


@dataclass
class Rounds:
    """The rounds of one search; `ladder.climb` says what the fields are.

    settings  with the floor of the machine as it stands
    afresh    the candidates were ranked in a poor valley once, and are ranked anew
    """

    residuals: Mapping[str, Problem]
    names: Sequence[str]
    candidates: Sequence[type[Effect]]
    settings: Settings
    progress: Callable[[str], None]
    known: Ladder | None
    measure: Measure | None = None
    afresh: bool = False

    def goes_on(self, search: Ladder) -> bool:
        """Whether something may still be added to the last rung."""
        rung, validate, settings = search.rungs[-1], self.residuals["validate"], self.settings
        if len(rung.effects) >= settings.rounds or len(search.rounds) >= MOST:
            return False
        # as the verdict will measure it, with what the length channel shows
        done = rms(rung.errors) < complete(validate, settings.floor)
        if not self._absent(rung) or (rung.effects and done):
            return False
        # with an effect the floor may be as low as the model's resolution
        least = RESOLUTION if self.measure else settings.floor
        error = rung.scores["validate"].rmse
        return settings.always or error >= least * effort_rms(validate)

    def add(self, search: Ladder) -> bool:
        """One round: the best candidate becomes a rung; False where none helps."""
        rung, settings, progress = search.rungs[-1], self.settings, self.progress
        # a round stays near its rung; what it ends with is scored, and finished, on the trials
        close = {**self.residuals, "train": near(self.residuals["train"], rung.fit.changes)}
        ranked, tried = self._finalists(search, close)
        alone = search.floor
        self._floor(search, tried)
        passed = self._passing(tried, search)
        if not passed:
            joint = self._pairs(ranked, rung, close)
            passed = self._passing(joint, search)
            tried += passed
        again = fitted_again(passed, rung, close, self.residuals["train"], settings, progress)
        if again is not None:
            poor = again.errors.mean() < POOR * rung.errors.mean()
            search.rungs[-1] = rung = again
            passed = self._passing(passed, search)
            if (poor or not passed) and not self.afresh:
                self.afresh, search.floor = True, alone
                return True
        ended = [to_the_end(c, self.residuals, settings, progress) for c in leading(passed)]
        leaders = [c for c in ended if periodic(c, self.residuals["train"])]
        improved = {c.effects: c for c in leaders}
        smooth = {c.effects for c in ended} - set(improved)
        tried = [improved.get(c.effects, c) for c in tried if c.effects not in smooth]
        search.screened.append(ranked)
        search.rounds.append(with_probability(tried, rung, close["train"], settings))
        if leaders:
            self._grow(search, leaders, close)
        else:
            search.floor = alone
        return bool(leaders)

    def _floor(self, search: Ladder, tried: Sequence[Confirmed]) -> None:
        """The floor of the machine that has the best candidate, where that is the lower one.

        Without an effect that is there the fitted numbers make up for it.  They may stand where
        builds differ by far more than those of the machine itself.
        """
        if self.measure and search.floor and tried and not search.rungs[-1].effects:
            best = min(tried, key=lambda c: float(c.errors.mean()))
            search.floor = min(search.floor, self.measure(best.fit), key=lambda f: f.share)
            self.settings = search.settings(self.settings)

    def _absent(self, rung: Rung) -> list[type[Effect]]:
        return [c for c in self.candidates if c not in rung.effects]

    def _finalists(
        self, search: Ladder, close: Mapping[str, Problem]
    ) -> tuple[list[Screened], list[Confirmed]]:
        """All candidates as the screening ranks them; the best of them after a full refit."""
        rung, train, settings = search.rungs[-1], close["train"], self.settings
        absent, done = self._absent(rung), {}
        seen = self.known if self.known and not (search.screened or self.afresh) else None
        if seen and _screened_here(seen):
            ranked = [s for s in seen.screened[0] if s.effect in absent]
            done = {c.effects: c for c in seen.rounds[0]}
        else:
            fitted = _names(rung, self.names, train)
            ranked = screen(train, rung.fit, fitted, absent, settings.scale)
        best = ", ".join(f"{s.effect.name()} {s.gain:+.0%}" for s in ranked[:5])
        self.progress(f"screened: {best}")
        return ranked, [
            done.get((s.effect,)) or confirm([s], rung, close, settings, self.progress)
            for s in ranked[: self._kept(rung)]
            if s.gain > 0.0
        ]

    def _kept(self, rung: Rung) -> int:
        return max(1, self.settings.finalists - len(rung.effects))

    def _pairs(
        self, ranked: Sequence[Screened], rung: Rung, close: Mapping[str, Problem]
    ) -> list[Confirmed]:
        """The first finalists two by two, where nothing was added yet and much is left."""
        enough = complete(close["validate"], self.settings.floor)
        if rung.effects or rung.scores["validate"].rmse <= enough:
            return []
        first = [s for s in ranked[: self._kept(rung)] if s.gain > 0.0][:PAIRED]
        return [
            confirm(pair, rung, close, self.settings, self.progress)
            for pair in combinations(first, 2)
        ]

    def _passing(self, tried: Sequence[Confirmed], search: Ladder) -> list[Confirmed]:
        """Those that count as effects beside the last rung."""
        rung, validate = search.rungs[-1], self.residuals["validate"]
        least = least_of(search, validate, self.settings)
        return [c for c in tried if counts(c, rung, self.residuals, self.settings, least)]

    def _grow(
        self, search: Ladder, leaders: Sequence[Confirmed], close: Mapping[str, Problem]
    ) -> None:
        """Add the simplest of the leaders, and question what stood before."""
        settings = self.settings
        best = finished(
            simplest(leaders, self.residuals["train"], settings), self.residuals, settings
        )
        effects = [*search.rungs[-1].effects, *best.effects]
        grown = Rung(f"+ {label(effects)}", effects, best.fit, best.scores, best.errors)
        search.rungs.append(grown)
        # of two that were added together each needs what a second one needs beside a first
        least = least_of(search, close["validate"], settings)
        pruned(search, close, settings, self.progress, least)
        exchanged(search, self.candidates, self.residuals, settings, self.progress)


def _screened_here(known: Ladder) -> bool:
    """Whether the first round began at the fit with which the search began."""
    return bool(known.screened and known.rounds) and known.rungs[0] is known.base


def _names(rung: Rung, fitted: Sequence[str], problem: Problem) -> list[str]:
    """The numbers of a rung that are fitted along: the model's, and amplitudes of its effects."""
    return [*fitted, *(n for e in rung.effects for n in amplitudes(e, problem))]


NEAR = 0.03  # of its range: a number so close to a bound is held by it


def climb(
    residuals: Mapping[str, Problem],
    names: Sequence[str],
    candidates: Sequence[type[Effect]],
    start: Mapping[str, float],
    settings: Settings,
    progress: Callable[[str], None] = lambda text: None,
    known: Ladder | None = None,
    measure: Measure | None = None,
) -> Ladder:
    """Search for missing effects; residuals by role share one plant that holds all candidates.

    names  parameters fitted at every rung;  start  where their fit begins.  What the data do not
           tell without an effect stays at its place on the first rung only: with the effect that
           is missing it may well be told
    known  an earlier search of the same trials, begun or among more candidates: its fit of the
           parameters alone, its first screening and what it fitted there are taken over, less who
           does not take part now
    measure  the floor of a machine with such a fit; None: that of the settings stands
    """
    candidates = _in_question(candidates, names, progress)
    # a line for each round's screening, finalist and leader, and for what is questioned after it
    progress = Steps(progress, 1 + settings.rounds * (settings.finalists + LEADERS + 2))
    search = _known(known) if known else begun(residuals, names, start, settings)
    progress(f"parameters only: {line(search.rungs[0].scores, residuals['validate'].effort)}")
    if measure:
        search.floor = measure(search.rungs[0].fit)
        progress(f"floor: {search.floor.reason}")
    settings = search.settings(settings)
    rounds = Rounds(residuals, names, candidates, settings, progress, known, measure)
    while rounds.goes_on(search) and rounds.add(search):
        pass
    _without_unlikely(search, residuals, settings)
    return search


def _without_unlikely(search: Ladder, residuals: Mapping[str, Problem], settings: Settings) -> None:
    """Take what was added beside a first effect away again, where its name is unlikely."""
    while len(search.rungs) > 2:
        last, below = search.rungs[-1].effects, search.rungs[-2].effects
        found = weighed(search, residuals, settings)
        likely = all(found[e.name()].probability >= LIKELY for e in last if e not in below)
        if likely or not set(below) < set(last):
            return
        search.rungs.pop()


def _in_question(
    candidates: Sequence[type[Effect]], names: Sequence[str], progress: Callable[[str], None]
) -> list[type[Effect]]:
    """Those that do not the same as a fitted number."""
    for same in [c for c in candidates if set(c.stands_for) & set(names)]:
        progress(f"{same.name()} is no candidate: a fitted number does the same")
    return [c for c in candidates if not set(c.stands_for) & set(names)]


def begun(
    residuals: Mapping[str, Problem],
    names: Sequence[str],
    start: Mapping[str, float],
    settings: Settings,
    steps: Sequence[float] = STEPS,
) -> Ladder:
    """A search that has not looked for anything yet: the fit of the parameters alone.

    steps  of its differences; the last alone where `start` is a fit with the wide ones
    """
    train = residuals["train"]
    cheap = near(train, start)
    first = fit(cheap, names, start, settings.scale, settings.patience, steps=steps, exact=False)
    first = off_its_bounds(cheap, first, settings)
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
    return Ladder(base, [base], vague=vague)


def off_its_bounds(train: Problem, found: Fit, settings: Settings) -> Fit:
    """The fit, or one from where the numbers that ended at a bound stand on the data sheet.

    A first step far from the optimum may take a number to its bound, and the others into a valley
    beside it.  What belongs at its bound comes back to it.
    """
    scaling = Scaling(train.table, list(found.estimates))
    values = dict(zip(train.table.names, train.table.values.tolist(), strict=True))
    u = scaling.scaled({**values, **found.changes})
    low, high = scaling.around(u)
    room = NEAR * (high - low)
    at_bound = (u < low + room) | (u > high - room)
    bound = {n for n, out in zip(found.estimates, at_bound, strict=True) if out}
    if not bound:
        return found
    begin = {k: v for k, v in found.changes.items() if k not in bound}
    again = fit(train, list(found.estimates), begin, settings.scale, settings.patience, exact=False)
    return again if again.cost < (1.0 - CLEARLY) * found.cost else found


def _known(earlier: Ladder) -> Ladder:
    return Ladder(earlier.base, [earlier.base], vague=list(earlier.vague))
