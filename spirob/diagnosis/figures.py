"""What a search shows of each chosen effect: the figures of `certainty`, and what is of its kin."""

from collections.abc import Collection
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from spirob.diagnosis.certainty import ratio, rounded, sharp
from spirob.diagnosis.model import Left, Model
from spirob.diagnosis.search import Found, Search, alike
from spirob.effects import Effect

MOSTLY = 0.5  # of the squared error that an effect takes: what differs by less makes most of it


@dataclass(frozen=True)
class Ended:
    """A search, what it found, and what is left beside the chosen model."""

    search: Search[Any]
    found: Found
    left: Left


def kin(search: Search[Any], chosen: Model, effect: type[Effect]) -> list[str]:
    """Names of the effects that make most of what this one makes, in its place; the best first.

    Their models differ from the chosen one by less than half the squared error that the effect
    takes, on the samples that are fitted; the held-out trials refute none of them.
    """
    rest = chosen.names - {effect.name()}
    fall = search.models.tried[rest].mean_square - chosen.mean_square
    found = {}
    for model in search.models.tried.values():
        other = model.names - rest
        if len(other) != 1 or len(model.names) != len(chosen.names) or model.names == chosen.names:
            continue
        apart = float(np.mean((model.fit.residual - chosen.fit.residual) ** 2))
        if apart < MOSTLY * fall and not search.worth.refuted(model, chosen):
            found[next(iter(other))] = model.heldout_square
    return sorted(found, key=lambda name: found[name])


def figures(ended: Ended, effect: type[Effect]) -> dict[str, float]:
    """What the search shows of one chosen effect."""
    search, found, left = ended.search, ended.found, ended.left
    chosen, bare = found.chosen, found.rungs[0]
    without = search.models.tried[chosen.names - {effect.name()}]
    fall = without.mean_square - chosen.mean_square
    order = [next(iter(b.names - a.names)) for a, b in pairwise(found.rungs)]

    def ahead(of: Collection[str]) -> float:
        others = [m.heldout_square for m in _others(search, chosen, of)]
        return ratio(min(others, default=bare.heldout_square), chosen.heldout_square)

    told = {
        "fall_heldout": ratio(without.heldout_square, chosen.heldout_square),
        "ahead_heldout": ahead({effect.name()}),
        "ahead_of_kin": ahead({effect.name(), *kin(search, chosen, effect)}),
        "left": ratio(left.share * chosen.mean_square, max(fall, 0.0)),
        "sharp": sharp(chosen.fit, effect),
        "place": float(order.index(effect.name())),
        "late": left.late,
    }
    return rounded(told)


def _others(search: Search[Any], chosen: Model, names: Collection[str]) -> list[Model]:
    return [
        m
        for m in search.models.tried.values()
        if m.names.isdisjoint(names)
        and len(m.effects) <= len(chosen.effects)
        and not alike(m, chosen, search.worth.least)
    ]
