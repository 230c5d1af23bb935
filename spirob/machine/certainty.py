"""How sure is a name?  Six figures of a search, and how often names with such figures were right.

    p = 1/(1 + exp(-(w₀ + Σ w_k (x_k - m_k)/s_k)))

x are the figures of one chosen effect; w, m, s stand in `certainty.json` beside this file, with the
cases that they were fitted to (`spirob.campaign.calibration`).
"""

import json
from collections.abc import Collection
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from spirob.effects import Effect
from spirob.machine.alignment import usual
from spirob.machine.candidates import alike
from spirob.machine.flexible import Ceiling
from spirob.machine.models import Model
from spirob.machine.search import Found, Search

LEARNED = json.loads(Path(__file__).with_name("certainty.json").read_text())
FIGURES = (
    "fall_heldout",
    "ahead_heldout",
    "left",
    "sharp",
    "place",
    "late",
)
MOSTLY = 0.5  # of the squared error that an effect takes: what differs by less makes most of it
TINY = 1e-300
MOST = 10.0  # of a logarithm: what is larger says no more


@dataclass(frozen=True)
class Ended:
    """A search, what it found, and what still follows from the motion beside the chosen model."""

    search: Search
    found: Found
    rest: Ceiling


def probability(figures: dict[str, float]) -> float:
    """How likely a name with these figures is right, as it was in the campaign."""
    x = np.array([figures[name] for name in FIGURES])
    mean, scale, weights = (np.array(LEARNED[key]) for key in ("mean", "scale", "weights"))
    return float(1.0 / (1.0 + np.exp(-(LEARNED["bias"] + weights @ ((x - mean) / scale)))))


def kin(search: Search, chosen: Model, effect: type[Effect]) -> list[str]:
    """Names of the effects that make most of what this one makes, in its place; the best first.

    Their models differ from the chosen one by less than half the squared error that the effect
    takes, on the samples that are fitted.
    """
    rest = chosen.names - {effect.name()}
    fall = search.models.tried[rest].mean_square - chosen.mean_square
    found = {}
    for model in search.models.tried.values():
        other = model.names - rest
        if len(other) != 1 or len(model.names) != len(chosen.names) or model is chosen:
            continue
        apart = float(np.mean((model.fit.residual - chosen.fit.residual) ** 2))
        if apart < MOSTLY * fall:
            found[next(iter(other))] = model.heldout_square
    return sorted(found, key=lambda name: found[name])


def figures(ended: Ended, effect: type[Effect], same: Collection[str] = ()) -> dict[str, float]:
    """What the search shows of one chosen effect; logarithms are natural, errors squared.

    same  names that count as this effect, too: the figures are then of all of them

    fall_heldout   ln of the held-out error without it over that with it
    ahead_heldout  ln of the held-out error of the best other model over that of the chosen one;
                   the other is no richer, without the effect, and says something else
    left           ln of what still follows from the motion, over what this effect took
    sharp          ln of an amplitude over half its interval's width, of the sharpest
    place          0 for the effect that takes most, then 1, 2, ...
    late           ln(1 + |delay| over the usual one)
    """
    search, found, rest = ended.search, ended.found, ended.rest
    chosen, bare = found.chosen, found.rungs[0]
    without = search.models.tried[chosen.names - {effect.name()}]
    fall = without.mean_square - chosen.mean_square
    others = [m.heldout_square for m in _others(search, chosen, {effect.name(), *same})]
    order = [next(iter(b.names - a.names)) for a, b in pairwise(found.rungs)]
    delay = chosen.fit.estimates.get("rig.delay")
    period = max(r.period for r in search.train.recordings)
    told = {
        "fall_heldout": _ln(without.heldout_square, chosen.heldout_square),
        "ahead_heldout": _ln(min(others, default=bare.heldout_square), chosen.heldout_square),
        "left": _ln(rest.share * chosen.mean_square, fall),
        "sharp": _sharp(chosen, effect),
        "place": float(order.index(effect.name())),
        "late": float(np.log1p(abs(delay.value) / usual(period))) if delay else 0.0,
    }
    return {name: float(f"{value:.6g}") for name, value in told.items()}


def _others(search: Search, chosen: Model, names: Collection[str]) -> list[Model]:
    return [
        m
        for m in search.models.tried.values()
        if m.names.isdisjoint(names)
        and len(m.effects) <= len(chosen.effects)
        and not alike(m, chosen, search.worth.least)
    ]


def _sharp(model: Model, effect: type[Effect]) -> float:
    """How far an amplitude is from what makes it neutral, in half widths of its interval: ln."""
    found = []
    for field, zero in effect.neutral.items():
        estimate = model.fit.estimates[f"{effect.name()}.{field}"]
        found.append(_ln(abs(estimate.value - zero), 0.5 * (estimate.high - estimate.low)))
    return max(found, default=0.0)


def _ln(one: float, two: float) -> float:
    return float(np.clip(np.log(max(one, TINY) / max(two, TINY)), -MOST, MOST))
