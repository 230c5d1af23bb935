"""Which effects say the same in richer or poorer words: at most one of them may be missing."""

from collections.abc import Collection
from itertools import combinations

import numpy as np

from spirob.effects import Effect
from spirob.machine.dry import falls, is_dry
from spirob.machine.laws import shares_inertia
from spirob.machine.models import Model
from spirob.machine.scaling import Sizes
from spirob.machine.shapes import counts_periods


def related(effect: type[Effect], others: Collection[type[Effect]]) -> bool:
    """Whether one of the others is the same kind of law, of which a machine has only one.

    The sum of two laws of dry friction is a third one, with a transition that fits anything.  Only
    what they say of different things belongs together: how friction turns round at a reversal, and
    how its level falls with speed.  And one load stays behind the motor in one way: play has its
    teeth's spring already.
    """
    if shares_inertia(effect):
        return any(shares_inertia(other) for other in others)
    return is_dry(effect) and any(is_dry(o) and not _complete(effect, o) for o in others)


def _complete(one: type[Effect], other: type[Effect]) -> bool:
    """Whether one law tells how friction turns round, the other how its level falls with speed."""
    memory, level = (one, other) if one.state else (other, one)
    return bool(memory.state) and not level.state and falls(level)


def same_wave(model: Model, sizes: Sizes) -> bool:
    """Whether two of a model's effects are waves of one order, as far as the stroke can tell.

    Each of several laws can ripple at the same order; two of them together fit the edges of any.
    """
    apart = 2 * np.pi * sizes.angle / sizes.stroke
    orders = [
        model.fit.changes[f"{e.name()}.{f}"]
        for e in model.effects
        for f in e.parameters()
        if f not in e.neutral and counts_periods(e, f)
    ]
    return any(abs(one - two) < apart for one, two in combinations(orders, 2))
