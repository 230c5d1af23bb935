"""What the search on an arm shows of each effect that was added: the figures of `certainty`."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from spirob.diagnosis.certainty import probability, ratio, rounded, sharp
from spirob.diagnosis.evidence import alike
from spirob.diagnosis.flexible import ceiling
from spirob.diagnosis.rungs import Confirmed, Ladder, Rung, Settings
from spirob.effects import Effect
from spirob.identify.problem import Problem


@dataclass(frozen=True)
class Weighed:
    """An added effect: its figures, and how likely its name is right."""

    figures: dict[str, float]

    @property
    def probability(self) -> float:
        """Learned from machines whose truth is known."""
        return probability(self.figures)


def weighed(
    search: Ladder, residuals: Mapping[str, Problem], settings: Settings
) -> dict[str, Weighed]:
    """Each effect of the last rung by name, the one that was added first at the beginning."""
    last = search.rungs[-1]
    if not last.effects:
        return {}
    missed = {
        role: last.fit.residual if role == "train" else problem(last.fit.changes)
        for role, problem in residuals.items()
    }
    rest = ceiling(residuals, missed).share * _square(last, "train")
    found = {}
    for place, (below, rung) in enumerate(pairwise(search.rungs)):
        tried = search.rounds[place] if place < len(search.rounds) else []
        for effect in rung.effects:
            if effect in last.effects and effect not in below.effects:
                others = _others(effect, below, rung, tried, settings)
                after = _square(rung, "heldout")
                told = {
                    "fall_heldout": ratio(_square(below, "heldout"), after),
                    "ahead_heldout": ratio(min(others), after),
                    "left": ratio(rest, _square(below, "train") - _square(rung, "train")),
                    "sharp": sharp(rung.fit, effect),
                    "place": float(place),
                    "late": 0.0,  # logs of the arm are put right before
                }
                found[effect.name()] = Weighed(rounded(told))
    return found


def _others(
    effect: type[Effect], below: Rung, rung: Rung, tried: list[Confirmed], settings: Settings
) -> list[float]:
    """Held-out errors, squared: of the rung below, and of those that would have said otherwise."""
    size = float(np.sqrt(max(below.errors.mean() - rung.errors.mean(), 1e-300)))
    own = [c for c in tried if effect in c.effects and set(c.effects) <= set(rung.effects)]
    added = len(rung.effects) - len(below.effects)
    found = [_square(below, "heldout")]
    for other in tried:
        if effect in other.effects or len(other.effects) > max(added, 1):
            continue
        if not any(alike(c.missed, other.missed, size) < settings.alike for c in own):
            found.append(_square(other, "heldout"))
    return found


def _square(found: Rung | Confirmed, role: str) -> float:
    return found.scores[role].rmse ** 2
