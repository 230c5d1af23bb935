"""How sure is a name?  The figures of a search that tell it, for each chosen effect."""

from itertools import pairwise

import numpy as np

from spirob.diagnosis.noise import noise_floor
from spirob.effects import Effect
from spirob.machine.alignment import usual
from spirob.machine.equivalence import alike
from spirob.machine.flexible import Ceiling
from spirob.machine.models import Model
from spirob.machine.search import Found, Search

TINY = 1e-300
MOST = 10.0  # of a logarithm: what is larger says no more


def figures(
    search: Search, found: Found, rest: Ceiling, effect: type[Effect], wins: float, doubts: int
) -> dict[str, float]:
    """What the search shows of one chosen effect; logarithms are natural, errors squared.

    wins       share of the redrawn blocks in which it beats rivals and its absence
    fall       ln of the error without it over that with it, on folds left out
    fall_heldout  the same on the held-out trials
    size       ln of its size over the least size that counts
    part       ln of the fall that it makes over the bare model's error
    steady     mean over deviation of the blocks' logarithmic falls, times √blocks
    ahead      ln of the error of the best other model, no richer and without it, over that chosen
    ahead_heldout  the same on the held-out trials
    left       ln of (what of the rest still follows from the motion, over what this effect took)
    follows    share of the rest that follows from the motion
    taken      ln of the bare model's error over the chosen one's;  taken_heldout  held out
    remaining  ln of the held-out RMS over the effort's;  above  ln of it over the noise floor
    sharp      ln of its sharpest amplitude over half the width of that one's interval
    at_bound   how many of the fitted numbers ended at a bound
    late       ln(1 + |delay| over the usual one)
    blocks     ln of the half seconds compared
    place      0 for the effect that takes most, then 1, 2, ...;  others  chosen effects besides
    numbers    that it has;  close  rivals that are not told apart
    doubts     reasons to doubt logs or description
    """
    chosen, bare = found.chosen, found.rungs[0]
    without = search.models.tried[chosen.names - {effect.name()}]
    falls = np.log((without.errors + TINY) / (chosen.errors + TINY))
    spread = float(np.std(falls, ddof=1)) if len(falls) > 1 else 0.0
    fall = max(without.mean_square - chosen.mean_square, TINY)
    left = max(rest.share * chosen.mean_square, TINY)
    remaining = np.sqrt(chosen.heldout_square)
    others = _others(search, chosen, effect)
    nearest = min((m.mean_square for m in others), default=bare.mean_square)
    nearest_held = min((m.heldout_square for m in others), default=bare.heldout_square)
    estimates = chosen.fit.estimates
    order = [next(iter(b.names - a.names)) for a, b in pairwise(found.rungs)]
    delay = estimates.get("rig.delay")
    period = max(r.period for r in search.train.recordings)
    told = {
        "wins": wins,
        "fall": _ln(without.mean_square, chosen.mean_square),
        "fall_heldout": _ln(without.heldout_square, chosen.heldout_square),
        "size": 0.5 * _ln(fall, search.worth.least**2),
        "part": _ln(fall, bare.mean_square),
        "steady": float(np.mean(falls)) / max(spread, 1e-9) * np.sqrt(len(falls)),
        "ahead": _ln(nearest, chosen.mean_square),
        "ahead_heldout": _ln(nearest_held, chosen.heldout_square),
        "left": _ln(left, fall),
        "follows": rest.share,
        "taken": _ln(bare.mean_square, chosen.mean_square),
        "taken_heldout": _ln(bare.heldout_square, chosen.heldout_square),
        "remaining": _ln(remaining, search.models.size),
        "above": _ln(remaining, max(float(noise_floor(search.train)), TINY)),
        "sharp": _sharp(chosen, effect),
        "at_bound": float(sum(e.at_bound for e in estimates.values())),
        "late": float(np.log1p(abs(delay.value) / usual(period))) if delay else 0.0,
        "blocks": float(np.log(len(falls))),
        "place": float(order.index(effect.name())),
        "others": float(len(chosen.effects) - 1),
        "numbers": float(len(effect.parameters())),
        "close": float(len(found.rivals[effect.name()])),
        "doubts": float(doubts),
    }
    return {name: float(f"{value:.6g}") for name, value in told.items()}


def _others(search: Search, chosen: Model, effect: type[Effect]) -> list[Model]:
    """Models without the effect that are no richer and say something else."""
    return [
        m
        for m in search.models.tried.values()
        if effect.name() not in m.names
        and len(m.effects) <= len(chosen.effects)
        and not alike(m, chosen, search.worth.least)
    ]


def _sharp(model: Model, effect: type[Effect]) -> float:
    """How far an amplitude is from what makes it neutral, in half widths of its interval: ln."""
    found = []
    for field, zero in effect.neutral.items():
        estimate = model.fit.estimates[f"{effect.name()}.{field}"]
        half = max(0.5 * (estimate.high - estimate.low), TINY)
        found.append(_ln(abs(estimate.value - zero) + TINY, half))
    return max(found, default=0.0)


def _ln(one: float, two: float) -> float:
    return float(np.clip(np.log(max(one, TINY) / max(two, TINY)), -MOST, MOST))
