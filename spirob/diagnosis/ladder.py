"""The search: screen, confirm in full simulation, add the best, refit everything, repeat.

Fits use the training trials, decisions the validation trials; the held-out trials are only
reported.  A candidate is added only if the rung below, fitted again from the candidate's own
numbers, does not do as well; of candidates that do about equally well the simplest is added; where
none helps alone, pairs are tried; and once two are in, each has to be needed beside the other.
"""

from collections.abc import Callable, Mapping, Sequence

from spirob.diagnosis.confirm import CLEARLY
from spirob.diagnosis.rounds import Rounds
from spirob.diagnosis.rungs import Search, Settings, line, rung_of
from spirob.diagnosis.weighing import LEADERS
from spirob.effects import Effect
from spirob.identify.fit import STEPS, Fit, fit, fit_identifiable
from spirob.identify.near import near
from spirob.identify.problem import Problem
from spirob.identify.scaling import Scaling
from spirob.told import Steps

NEAR = 0.03  # of its range: a number so close to a bound is held by it


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
    candidates = _in_question(candidates, names, progress)
    # a line for each round's screening, finalist and leader, and for what is questioned after it
    progress = Steps(progress, 1 + settings.rounds * (settings.finalists + LEADERS + 2))
    search = _known(known) if known else begun(residuals, names, start, settings)
    progress(f"parameters only: {line(search.rungs[0].scores, residuals['validate'].effort)}")
    rounds = Rounds(residuals, names, candidates, settings, progress, known)
    while rounds.goes_on(search) and rounds.add(search):
        pass
    return search


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
) -> Search:
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
    return Search(base, [base], vague=vague)


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


def _known(earlier: Search) -> Search:
    return Search(earlier.base, [earlier.base], vague=list(earlier.vague))
