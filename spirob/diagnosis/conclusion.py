"""What stands of a search, and how likely each of its effects is.

What imitates another effect goes, and what cannot be told from others, and what is unlikely beside
what is likely.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from spirob.diagnosis.certainty import LIKELY, Ended, figures, kin, probability, proven
from spirob.diagnosis.model import Found, Model
from spirob.diagnosis.search import Search

Denied = Callable[[Model], Collection[str]]  # names of its effects that something else denies


@dataclass(frozen=True)
class Weighed:
    """A chosen effect: how likely its name is right, what says the same, what else it could be.

    together     how likely it is right that this effect or one of its rivals is there
    equivalents  names of effects that say the same of these data;  rivals  of those that do not
    figures      of `certainty`
    """

    probability: float
    together: float
    equivalents: list[str] = field(default_factory=list)
    rivals: list[str] = field(default_factory=list)
    figures: dict[str, float] = field(default_factory=dict)

    def proven(self, share: float) -> "Weighed":
        """The same once it accounts for this share of a trial of its own."""
        alone, together = (proven(p, share) for p in (self.probability, self.together))
        return replace(self, probability=alone, together=together)

    @property
    def denied(self) -> "Weighed":
        """The same, not likely at all."""
        return replace(self, probability=0.0, together=0.0)

    def as_dict(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)


def likely(weighed: Mapping[str, Weighed]) -> list[str]:
    """Names that are more likely right than wrong, alone or with those that say most of it."""
    return [name for name, one in weighed.items() if one.together >= LIKELY]


def concluded(
    search: Search[Any], found: Found, denied: Denied = lambda model: ()
) -> tuple[Ended, dict[str, Weighed]]:
    """What stands of a search, and how likely each chosen effect is.

    What imitates goes, and so does what is unlikely beside what is likely; it stays among the
    weighed.  What was likely beside it has to be confirmed without it, and is exchanged for what
    does better alone.
    """
    left = search.models.left(found.chosen)
    while (lesser := search.without_imitations(found, left.share)) is not None:
        found, left = lesser, search.models.left(lesser.chosen)
    ended = Ended(search, found, left)
    weighed = weigh(ended, denied)
    ended, weighed = _told_apart(ended, weighed, denied)
    while 0 < len(kept := likely(weighed)) < len(ended.found.chosen.effects):
        found = search.narrowed(ended.found, kept)
        ended = Ended(search, found, search.models.left(found.chosen))
        weighed = {**weighed, **_denied_alone(ended, weighed)}
    if 0 < len(kept) < len(weighed) and (other := search.exchanged(ended.found)):
        again = Ended(search, other, search.models.left(other.chosen))
        told = weigh(again, denied)
        if len(likely(told)) == len(told) > 0:
            ended, weighed = again, {n: w for n, w in weighed.items() if n not in kept} | told
    return ended, weighed


def _denied_alone(ended: Ended, weighed: Mapping[str, Weighed]) -> dict[str, Weighed]:
    """What the held-out trials confirm only beside what is gone: not likely at all."""
    search, chosen = ended.search, ended.found.chosen
    lesser = {e.name(): search.without(chosen, e) for e in chosen.effects}
    off = [name for name, model in lesser.items() if search.worth.denied(model, chosen)]
    return {name: weighed[name].denied for name in off}


def _told_apart(
    ended: Ended, weighed: dict[str, Weighed], denied: Denied
) -> tuple[Ended, dict[str, Weighed]]:
    """A search, without effects that cannot be told from the others, if one is likely then.

    Effects that make the same together are as vague as one another, and none of them is likely.
    Vague is an effect none of whose amplitudes is told: their intervals reach what is neutral, or
    they ended at a bound.
    The vaguest goes, of those without which no more is left than without another, by half.
    """
    search, found, told = ended.search, ended.found, weighed
    while len(told) > 1 and not likely(told):
        sharp = {e: told[e.name()].figures["sharp"] for e in found.chosen.effects}
        if min(sharp.values()) > 0.0:
            break
        lesser = {e: search.without(found.chosen, e) for e in sharp}
        best = search.worth.best(list(lesser.values()))
        spared = [e for e, model in lesser.items() if not search.worth.halves(model, best)]
        vaguest = min(spared, key=lambda e: sharp[e])
        found = search.less(found, vaguest)
        again = Ended(search, found, search.models.left(found.chosen))
        told = weigh(again, denied)
        if likely(told):
            return again, told
    return ended, weighed


def weigh(ended: Ended, denied: Denied = lambda model: ()) -> dict[str, Weighed]:
    """Each chosen effect by name; with its kin where only they together are likely.

    What held-out trials do not confirm is not likely at all, nor is what is `denied`.
    """
    found, veto = ended.found, ended.search.criteria.veto
    off, weighed = denied(found.chosen), {}
    for effect in found.chosen.effects:
        name, shown = effect.name(), figures(ended, effect)
        refuted = shown["fall_heldout"] <= -np.log1p(-veto) or name in off
        own = 0.0 if refuted else probability(shown, name, ended.search.models.certainty)
        one = Weighed(own, own, found.equivalents[name], found.rivals[name], shown)
        unsure = 0.0 < own < LIKELY
        others = kin(ended.search, found, effect) if unsure else []
        weighed[name] = _with_kin(one, name, others)
    return weighed


def _with_kin(one: Weighed, name: str, others: Sequence[str]) -> Weighed:
    """An effect that is too unlikely alone, and its kin beside it if one of them is likely."""
    together = probability(one.figures, name, "kin") if others else 0.0
    if together < LIKELY:
        return one
    rivals = [*others, *(name for name in one.rivals if name not in others)]
    equivalents = [name for name in one.equivalents if name not in others]
    return replace(one, together=together, rivals=rivals, equivalents=equivalents)
