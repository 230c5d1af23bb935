"""Who stands beside what was found, as models that can be fitted again elsewhere."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from spirob.diagnosis.rungs import Confirmed, Search, label
from spirob.diagnosis.verdict import Verdict
from spirob.effects import Effect, find_effects


@dataclass(frozen=True)
class Contestant:
    """A fitted model that stands beside others.

    effects  none for the model without any;  names  of what is fitted;  changes  where that ended
    gain     what the screening promised
    """

    effects: tuple[type[Effect], ...]
    names: tuple[str, ...]
    changes: Mapping[str, float]
    gain: float = 0.0

    def as_dict(self) -> dict[str, Any]:
        """Plain data, for another process to go on from."""
        plain = {"names": list(self.names), "changes": dict(self.changes), "gain": self.gain}
        return {"effects": [e.name() for e in self.effects], **plain}

    @staticmethod
    def from_dict(plain: Mapping[str, Any]) -> "Contestant":
        """Back from plain data."""
        effects = tuple(find_effects(plain["effects"]))
        return Contestant(effects, tuple(plain["names"]), dict(plain["changes"]), plain["gain"])


def contest(search: Search, verdict: Verdict) -> list[Contestant]:
    """The model without any effect, then those that stand beside each other."""
    start = search.rungs[0].fit
    found = [Contestant((), tuple(start.estimates), start.changes)]
    for c in contestants(search, verdict):
        found.append(Contestant(c.effects, tuple(c.fit.estimates), c.fit.changes, c.gain))
    return found


def in_question(search: Search, verdict: Verdict) -> list[Contestant]:
    """The model without any effect, the one with what was found, and those beside it, if any."""
    last = search.rungs[-1]
    if verdict.contested and set(last.effects) in alone(search):
        return contest(search, verdict)
    return [
        Contestant(tuple(r.effects), tuple(r.fit.estimates), r.fit.changes)
        for r in (search.rungs[0], last)
    ]


def alone(search: Search) -> list[set[type[Effect]]]:
    """What the first round found: with more added since, it is not what is in question."""
    return [set(c.effects) for c in search.rounds[0]]


def contestants(search: Search, verdict: Verdict) -> list[Confirmed]:
    """The finalist that was found, then those that stand beside it, the most probable first.

    Only where the first round found it `alone`.
    """
    first, last = search.rounds[0], set(search.rungs[-1].effects)
    best = next(c for c in first if set(c.effects) == last)
    names = {*verdict.rivals, *verdict.equivalents}
    others = [c for c in first if c is not best and _beside(c, names)]
    return [best, *sorted(others, key=lambda c: -c.probability)]


def _beside(found: Confirmed, names: set[str]) -> bool:
    """Whether these names, of single effects or of pairs, hold this candidate."""
    return label(found.effects) in names or {e.name() for e in found.effects} <= names
