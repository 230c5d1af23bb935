"""Fits of an arm's model by simulation: briefly, until it settles, and from elsewhere.

Without a large effect the fitted numbers have moved far to make up for it, and from there its own
fit may end in a valley.  Where an effect is absent both its signs are alike in what they do to a
mirrored arm, and a fit that begins there may stay between them.  So what leads is fitted from the
data sheet, and from either side of absence, too.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spirob.diagnosis.criteria import Settings
from spirob.diagnosis.screen import Screened, amplitudes, beside
from spirob.effects import Effect
from spirob.effects.effect import differences
from spirob.identify.fit import STEPS, Fit, fit, fit_identifiable
from spirob.identify.problem import Problem
from spirob.identify.residual import near
from spirob.identify.scaling import Scaling

CLEARLY = 0.05  # relative fall of the cost that makes another fit the better one
HOPELESS = 2.0  # times the cost: what the cheap steps of a far fit may be off does not explain it
ASIDE = 0.5  # of the way from absence to a bound: where a fit of either sign begins
NEAR = 0.03  # of its range: a number so close to a bound is held by it
SLOWEST = 1.01  # times the lowest order that a wave may have: no more than that


def parameters_of(effect: type[Effect]) -> list[str]:
    """Full names of an effect's numbers, its motors' differences included."""
    return [f"{effect.name()}.{f}" for f in [*effect.fitted(), *differences(effect)]]


@dataclass(frozen=True)
class Begun:
    """The fit of the numbers alone, and names of those that the data do not tell."""

    fit: Fit
    vague: Sequence[str] = ()


def roughly(
    train: Problem,
    names: Sequence[str],
    start: Mapping[str, float],
    settings: Settings,
    steps: Sequence[float] = STEPS[-1:],
) -> Fit:
    """A fit from `start` at half the price, and without intervals."""
    scale, patience = settings.scale, settings.patience
    return fit(near(train, start), names, start, scale, patience, steps=steps, exact=False)


def begun(
    train: Problem,
    names: Sequence[str],
    start: Mapping[str, float],
    settings: Settings,
    steps: Sequence[float] = STEPS,
) -> Begun:
    """The fit of the numbers alone, from `start`.

    What the data do not tell without an effect stays at its place here only: with the effect that
    is missing it may well be told.

    steps  of its differences; the last alone where `start` is a fit with the wide ones
    """
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
    return Begun(found, vague)


def off_its_bounds(train: Problem, found: Fit, settings: Settings) -> Fit:
    """The fit, or one from where the numbers that ended at a bound stand on the data sheet.

    A first step far from the optimum may take a number to its bound, and the others into a valley
    beside it.  What belongs at its bound comes back to it.
    """
    scaling = Scaling(train.table, list(found.estimates))
    u = scaling.scaled(_whole(train, found.changes))
    low, high = scaling.around(u)
    room = NEAR * (high - low)
    at_bound = (u < low + room) | (u > high - room)
    bound = {n for n, out in zip(found.estimates, at_bound, strict=True) if out}
    if not bound:
        return found
    begin = {k: v for k, v in found.changes.items() if k not in bound}
    again = fit(train, list(found.estimates), begin, settings.scale, settings.patience, exact=False)
    return again if again.cost < (1.0 - CLEARLY) * found.cost else found


def confirmed(train: Problem, chosen: Sequence[Screened], settings: Settings) -> Fit:
    """One candidate, or several jointly, fitted from where the screening left it."""
    first = chosen[0]
    names, begin = list(first.names), dict(first.changes)
    for other in chosen[1:]:
        names += [n for n in other.names if n not in names]
        begin = {**other.changes, **begin}
    return briefly(train, names, begin, settings, first.slopes if len(chosen) == 1 else None)


def briefly(
    train: Problem,
    names: Sequence[str],
    begin: Mapping[str, float],
    settings: Settings,
    slopes: np.ndarray | None = None,
) -> Fit:
    """A fit that only has to be compared: few sets of differences, no intervals."""
    count = settings.iterations
    return fit(
        train, names, begin, settings.scale, count, steps=STEPS[-1:], exact=False, slopes=slopes
    )


def lastly(
    train: Problem,
    found: Fit,
    settings: Settings,
    names: Sequence[str] | None = None,
    slopes: np.ndarray | None = None,
    exact: bool = False,
) -> Fit:
    """A fit from where another ended until it settles, of more names where they are given."""
    return fit(
        train,
        list(names or found.estimates),
        found.changes,
        settings.scale,
        settings.patience,
        steps=STEPS[-1:],
        exact=exact,
        slopes=slopes,
    )


def to_the_end(
    train: Problem,
    effects: Sequence[type[Effect]],
    found: Fit,
    settings: Settings,
    enough: Callable[[Fit], bool],
) -> Fit:
    """A fit taken to where it settles, shapes included, from where it stands and from afar.

    It may stand far from where it began: the cheap steps are put right at its own numbers.

    enough  whether a fit leaves no more than a complete model
    """
    settled = shaped(near(train, found.changes), effects, found, settings)
    return anew(train, effects, settled, settings, enough)


def shaped(train: Problem, effects: Sequence[type[Effect]], found: Fit, settings: Settings) -> Fit:
    """Fitted until it settles, with its shapes too: a friction that yields before it slides is one
    only in its own distance."""
    names = list(found.estimates)
    shapes = [n for e in effects for n in parameters_of(e) if n not in names]
    shapes = [n for n in shapes if n in train.table.about]
    slopes = _widened(train, found, names, shapes) if shapes else found.jacobian
    return lastly(train, found, settings, [*names, *shapes], slopes)


def _widened(
    problem: Problem, known: Fit, names: Sequence[str], further: Sequence[str]
) -> np.ndarray:
    """Derivatives where a fit ended, with those by further numbers beside them."""
    scaling = Scaling(problem.table, [*names, *further])
    u = scaling.scaled(_whole(problem, known.changes))
    points, widths = beside(scaling, u, [STEPS[-1]] * len(further), known.changes)
    seen = zip(problem.many(points), widths, strict=True)
    return np.column_stack([known.jacobian, *((r - known.residual) / w for r, w in seen)])


def anew(
    train: Problem,
    effects: Sequence[type[Effect]],
    found: Fit,
    settings: Settings,
    enough: Callable[[Fit], bool],
) -> Fit:
    """The same fitted from afar, where that ends clearly lower.

    The data sheet first; what may have two signs from either side too, where much is still missed.
    """
    best = _lower(train, effects, found, {}, settings)
    for begin in sides(effects, train):
        if enough(best):
            break
        best = _lower(train, effects, best, begin, settings)
    return best


def sides(effects: Sequence[type[Effect]], problem: Problem) -> Iterator[dict[str, float]]:
    """Both sides of absence, for the first number of each effect if it has two."""
    table = problem.table
    for effect in effects:
        for name in amplitudes(effect, problem)[:1]:
            about, absent = table.about[name], float(table.values[table.position(name)])
            if about.low < absent < about.high:
                for bound in (about.low, about.high):
                    yield {name: absent + ASIDE * (bound - absent)}


def _lower(
    train: Problem,
    effects: Sequence[type[Effect]],
    found: Fit,
    begin: Mapping[str, float],
    settings: Settings,
) -> Fit:
    """`found`, or its fit from the data sheet and `begin` where that is clearly lower."""
    names = list(found.estimates)
    # shapes stay: of a wave's order no data sheet knows
    strengths = {n for e in effects for n in amplitudes(e, train)}
    own = {e.name() for e in effects}
    moved = {n for n in names if n in strengths or n.split(".")[0] not in own}
    start = {**{k: v for k, v in found.changes.items() if k not in moved}, **begin}
    far = roughly(train, names, start, settings, STEPS)
    if far.cost > HOPELESS * found.cost:
        return found
    again = briefly(near(train, far.changes), names, far.changes, settings, far.jacobian)
    return again if again.cost <= (1.0 - CLEARLY) * found.cost else found


def slowest(train: Problem, effects: Sequence[type[Effect]], found: Fit) -> list[type[Effect]]:
    """Effects with a wave that a fit takes to the slowest that its bounds allow."""
    table, values = train.table, train.table.vector(found.changes)
    orders = {e: f"{e.name()}.order" for e in effects}
    return [
        e
        for e, n in orders.items()
        if n in table.about and values[table.position(n)] <= SLOWEST * table.about[n].low
    ]


def without_slowest(train: Problem, effect: type[Effect], found: Fit, settings: Settings) -> Fit:
    """Fitted again, the slowest wave of an effect left out."""
    own = tuple(f"{effect.name()}.{phase}" for phase in ("sine", "cosine"))
    kept = {n: v for n, v in found.changes.items() if not n.startswith(own)}
    names = [n for n in found.estimates if n in kept]
    return briefly(near(train, kept), names, kept, settings)


def again_from(
    train: Problem,
    found: Fit,
    elsewhere: Mapping[str, float],
    own: Sequence[str],
    settings: Settings,
) -> Fit | None:
    """A fit from where a candidate's ended, less its `own` numbers; None if not clearly lower.

    An effect must not be named for having led the numbers out of a poor valley.
    """
    begin = {k: v for k, v in elsewhere.items() if k not in own}
    cheap, names = near(train, found.changes), list(found.estimates)
    again = briefly(cheap, names, begin, settings, found.jacobian)
    if again.cost > (1.0 - CLEARLY) * found.cost:
        return None
    return lastly(train, again, settings, exact=settings.intervals)


def _whole(problem: Problem, changes: Mapping[str, float]) -> dict[str, float]:
    """All numbers of the model, with these changed."""
    table = problem.table
    return {**dict(zip(table.names, table.values.tolist(), strict=True)), **changes}
