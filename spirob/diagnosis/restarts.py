"""A candidate fitted from elsewhere: from the data sheet, and from either side of absence.

Without a large effect the fitted numbers have moved far to make up for it, and from there its own
fit may end in a valley.  Where an effect is absent both its signs are alike in what they do to a
mirrored arm, and a fit that begins there may stay between them.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence

from spirob.diagnosis.confirm import CLEARLY, briefly, refitted, shaped
from spirob.diagnosis.evidence import complete
from spirob.diagnosis.rungs import Confirmed, Settings, label, line
from spirob.diagnosis.screen import amplitudes
from spirob.effects import Effect
from spirob.identify.fit import fit
from spirob.identify.problem import Problem
from spirob.identify.residual import near

HOPELESS = 2.0  # times the cost: what the cheap steps of a far fit may be off does not explain it
ASIDE = 0.5  # of the way from absence to a bound: where a fit of either sign begins


def to_the_end(
    found: Confirmed,
    residuals: Mapping[str, Problem],
    settings: Settings,
    progress: Callable[[str], None],
) -> Confirmed:
    """A leader fitted until it settles, from where it stands and from afar.

    It may stand far from its rung: the cheap steps are put right at its own numbers.
    """
    here = {**residuals, "train": near(residuals["train"], found.fit.changes)}
    return anew(shaped(found, here, settings, progress), residuals, settings, progress)


def anew(
    found: Confirmed,
    residuals: Mapping[str, Problem],
    settings: Settings,
    progress: Callable[[str], None],
) -> Confirmed:
    """The same fitted from afar, where that ends clearly lower.

    The data sheet first; what may have two signs from either side too, where much is still missed.
    """
    enough = complete(residuals["validate"], settings.floor)
    best = _lower(found, {}, "the data sheet", residuals, settings, progress)
    for begin in sides(found.effects, residuals["train"]):
        if best.scores["validate"].rmse <= enough:
            break
        where = ", ".join(f"{name} = {value:g}" for name, value in begin.items())
        best = _lower(best, begin, where, residuals, settings, progress)
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
    found: Confirmed,
    begin: Mapping[str, float],
    where: str,
    residuals: Mapping[str, Problem],
    settings: Settings,
    progress: Callable[[str], None],
) -> Confirmed:
    """`found`, or its fit from the data sheet and `begin` where that is clearly lower."""
    train, names = residuals["train"], list(found.fit.estimates)
    # shapes stay: of a wave's order no data sheet knows
    effects = {e.name() for e in found.effects}
    shapes = {n for n in names if n.split(".")[0] in effects} - {*_strengths(found, train)}
    moved = set(names) - shapes
    start = {**{k: v for k, v in found.fit.changes.items() if k not in moved}, **begin}
    far = fit(near(train, start), names, start, settings.scale, settings.patience, exact=False)
    if far.cost > HOPELESS * found.fit.cost:
        return found
    again = briefly(near(train, far.changes), names, far.changes, settings, far.jacobian)
    if again.cost > (1.0 - CLEARLY) * found.fit.cost:
        return found
    better = refitted(found, again, residuals)
    progress(f"{label(found.effects)} from {where}: {line(better.scores, train.effort)}")
    return better


def _strengths(found: Confirmed, problem: Problem) -> list[str]:
    """The fitted numbers that make its effects vanish."""
    own = [n for e in found.effects for n in amplitudes(e, problem)]
    return [n for n in own if n in found.fit.estimates]
