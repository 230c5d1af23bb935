"""What was added is questioned again, and candidates are fitted from elsewhere.

A candidate fitted from elsewhere: from the data sheet, and from either side of absence.

Without a large effect the fitted numbers have moved far to make up for it, and from there its own
fit may end in a valley.  Where an effect is absent both its signs are alike in what they do to a
mirrored arm, and a fit that begins there may stay between them.

Backward steps: what was added is questioned again.

The rung below is fitted again from where a candidate ended; an effect that is not needed beside a
later one goes; and the first of two, which was chosen without the second, may be exchanged.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence

from spirob.diagnosis.confirm import CLEARLY, briefly, confirm, finished, refitted, shaped
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
from spirob.diagnosis.screen import amplitudes, screen
from spirob.diagnosis.weighing import counts, with_probability
from spirob.effects import Effect
from spirob.identify.fit import STEPS, fit
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
    search.rungs[max(1, len(search.rungs) - 2) :] = [
        below,
        rung,
    ]  # beside two found at once: the base
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
