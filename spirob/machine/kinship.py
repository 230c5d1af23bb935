"""Which effects say the same in richer or poorer words: at most one of them may be missing."""

from collections.abc import Collection
from functools import cache
from itertools import combinations

import numpy as np

from spirob.effects import Effect
from spirob.machine.models import Model
from spirob.machine.scaling import Sizes
from spirob.machine.shapes import counts_periods

SPEEDS = {"motor.speed", "motor.rest_speed"}
SLOW, FAST = 1e3, 1e4  # rest speeds at which sliding friction has settled
SETTLING = 4000  # steps that a memory is given for that
STEP = 1e-3  # s


@cache
def is_dry(effect: type[Effect]) -> bool:
    """Whether this is a law of dry friction by speed alone: level at speed, and odd in it.

    Asked of the kernel itself, so that it holds for effects that nobody here has seen.
    """
    reads = set(effect.reads.values())
    if effect.port != "motor.torque" or "motor.speed" not in reads or not reads <= SPEEDS:
        return False
    slow, fast, back = (_settled(effect, v) for v in (SLOW, FAST, -FAST))
    return abs(fast) > 0.0 and abs(fast - slow) < 1e-3 * abs(fast) and fast * back < 0.0


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
        if f not in e.neutral and _counts(e, f)
    ]
    return any(abs(one - two) < apart for one, two in combinations(orders, 2))


@cache
def _counts(effect: type[Effect], field: str) -> bool:
    return counts_periods(effect, field)


def _settled(effect: type[Effect], speed: float) -> float:
    given = {a: 1.0 if s == "motor.rest_speed" else speed for a, s in effect.reads.items()}
    given |= {f: p.nominal for f, p in effect.parameters().items()}
    given |= {"dt": STEP} if "dt" in effect.arguments() else {}
    memory = dict(effect.state)
    if not memory:
        return float(effect.kernel(**given))
    for _ in range(SETTLING):
        out = effect.kernel(**given, **memory)
        memory = dict(zip(memory, out[1:], strict=True))
    return float(out[0])
