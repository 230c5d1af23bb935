"""What counts as an effect, and which of several is taken.

An effect has to be large enough to matter on trials that no fit has seen, and surely better than
what stood before it on all; of those that do about equally well the simplest is taken.

Thresholds that a configuration may set are `Rules` in `rungs`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from spirob.diagnosis.evidence import (
    beaten,
    block_errors,
    foreseen,
    improvement,
    win_rates,
)
from spirob.diagnosis.rungs import Confirmed, Ladder, Rung, Settings, label
from spirob.identify.fit import INDEPENDENT, Fit
from spirob.identify.problem import Problem, effort_rms

LEADERS = 2  # candidates fitted until they settle, with their shapes too
SLOWEST = 1.01  # times the lowest order that a wave may have: no more than that
SURELY = 0.95  # of draws in which a model with more numbers has to do better than a simpler one
LESSER = 0.5  # of the least size, of an effect beside another
REACH = 4.0  # times the least mean square: who missed more is fitted no further


def leading(passed: Sequence[Confirmed]) -> list[Confirmed]:
    """The best, and the next if it is within reach."""
    ranked = sorted(passed, key=lambda c: float(c.errors.mean()))
    return [c for c in ranked[:LEADERS] if c.errors.mean() <= REACH * ranked[0].errors.mean()]


def counts(
    found: Rung | Confirmed,
    below: Rung | Confirmed,
    residuals: Mapping[str, Problem],
    settings: Settings,
    least: float | None = None,
) -> bool:
    """Whether effects are large enough to matter and surely better than the rung below them.

    How large they are, trials that no fit has seen say.  How surely, those and the fitted ones: two
    short trials may hold an effect in two half-seconds alone, which one of eight draws leaves out.

    least  size that they have to have, in the unit of the effort; else the floor
    """
    validate, train = residuals["validate"], residuals["train"]
    if least is None:
        least = settings.floor * effort_rms(validate)
    if _size(below.errors, found.errors) < least:
        return False
    before, after = (_all_errors(r.errors, r.fit, train) for r in (below, found))
    return improvement(before, after, settings.seed)[1] > 0.0


def periodic(found: Confirmed, train: Problem) -> bool:
    """Whether the waves among its effects come round as often as something in the machine does.

    A wave that a fit takes to the slowest that its bounds allow stands for what is smooth: half a
    period of it passes for a constant, a slope or a bend.
    """
    orders = [f"{effect.name()}.order" for effect in found.effects]
    about, values = train.table.about, train.table.vector(found.fit.changes)
    return not any(
        values[train.table.position(n)] <= SLOWEST * about[n].low for n in orders if n in about
    )


def rms(errors: np.ndarray) -> float:
    """Of block errors of equal weight."""
    return float(np.sqrt(errors.mean()))


def _size(before: np.ndarray, after: np.ndarray) -> float:
    """√(MSE before - MSE after)."""
    return float(np.sqrt(max(0.0, float(before.mean() - after.mean()))))


def least_of(search: Ladder, validate: Problem, settings: Settings) -> float | None:
    """The least size of an effect beside the first of a search; none is said for the first.

    A share of what was added first, which may have been two together: beside each other each needs
    it.  Where that was small itself, at least half the floor: less is what builds differ by.
    """
    if len(search.rungs) == 1:
        return None
    share = settings.further * _size(search.rungs[0].errors, search.rungs[1].errors)
    return max(share, LESSER * settings.floor * effort_rms(validate))


def simplest(leaders: Sequence[Confirmed], train: Problem, settings: Settings) -> Confirmed:
    """The best, or one with fewer numbers that it beats in less than `SURELY` of the draws."""
    errors = [_all_errors(c.errors, c.fit, train) for c in leaders]
    means = [float(e.mean()) for e in errors]
    best = errors[int(np.argmin(means))]
    equal = [
        k
        for k, own in enumerate(errors)
        if own is best or beaten(own, best, settings.seed) < SURELY
    ]
    return leaders[min(equal, key=lambda k: (len(leaders[k].fit.estimates), means[k]))]


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
