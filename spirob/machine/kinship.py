"""Which effects say the same in richer or poorer words: at most one of them may be missing."""

from collections.abc import Collection
from itertools import combinations

import numpy as np

from spirob.effects import Effect
from spirob.machine.dry import is_dry
from spirob.machine.models import Model
from spirob.machine.scaling import Sizes
from spirob.machine.shapes import counts_periods


def related(effect: type[Effect], others: Collection[type[Effect]]) -> bool:
    """Whether one of the others is the same kind of law, of which a machine has only one.

    The sum of two laws of dry friction is a third one, with a transition that fits anything.
    """
    return is_dry(effect) and any(is_dry(other) for other in others)


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
