"""What the search on an arm shows of each effect that was added: the figures of `certainty`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from spirob.diagnosis.certainty import probability, ratio, rounded, sharp
from spirob.diagnosis.evidence import alike, complete
from spirob.diagnosis.flexible import ceiling
from spirob.diagnosis.rungs import Confirmed, Ladder, Rung, Settings, missed_by
from spirob.effects import Effect
from spirob.identify.problem import Problem

LEAST = 0.1  # of the square that a complete model leaves
VETO = 0.05  # of the held-out square, as of rigs: what takes no more off is not confirmed


@dataclass(frozen=True)
class Weighed:
    """An added effect: its figures, and how likely its name is right."""

    figures: dict[str, float]

    @property
    def probability(self) -> float:
        """Learned from machines whose truth is known; 0 where held-out trials do not confirm it."""
        return probability(self.figures) if self.figures["fall_heldout"] > VETO else 0.0


def weighed(
    search: Ladder, residuals: Mapping[str, Problem], settings: Settings
) -> dict[str, Weighed]:
    """Each effect of the last rung by name, the one that was added first at the beginning.

    Errors are taken above what a complete model of such a machine leaves, of which a tenth counts
    at least: by how much less is left says nothing of a name.
    """
    last = search.rungs[-1]
    if not last.effects:
        return {}
    above = Above(residuals, settings.floor)
    rest = follows(last, residuals) * _square(last, "train")
    found = {}
    for place, (below, rung) in enumerate(pairwise(search.rungs)):
        tried = search.rounds[place] if place < len(search.rounds) else []
        for effect in rung.effects:
            if effect not in last.effects or effect in below.effects:
                continue
            others: list[Rung | Confirmed] = [below, *_others(effect, below, rung, tried, settings)]
            after = above(rung, "heldout")
            fall = _square(below, "train") - _square(rung, "train")
            told = {
                "fall_heldout": ratio(above(below, "heldout"), after),
                "ahead_heldout": ratio(min(above(o, "heldout") for o in others), after),
                "left": ratio(above.square(rest, "train"), fall),
                "sharp": sharp(rung.fit, effect),
                "place": float(place),
                "late": 0.0,  # logs of the arm are put right before
            }
            found[effect.name()] = Weighed(rounded(told))
    return found


def follows(rung: Rung, residuals: Mapping[str, Problem]) -> float:
    """Share of what a rung leaves, squared, that follows from the motion on folds left out."""
    return ceiling(residuals, missed_by(rung, residuals)).share


@dataclass(frozen=True)
class Above:
    """Squared errors above those of a complete model."""

    residuals: Mapping[str, Problem]
    floor: float

    def __call__(self, found: Rung | Confirmed, role: str) -> float:
        """Of a fitted model, in the unit of the effort, squared."""
        return self.square(_square(found, role), role)

    def square(self, error: float, role: str) -> float:
        """Of a squared error."""
        least = complete(self.residuals[role], self.floor) ** 2
        return max(error - least, LEAST * least)


def _others(
    effect: type[Effect], below: Rung, rung: Rung, tried: Sequence[Confirmed], settings: Settings
) -> list[Confirmed]:
    """Those that were tried instead of an effect, are no richer, and say something else."""
    size = float(np.sqrt(max(below.errors.mean() - rung.errors.mean(), 1e-300)))
    own = [c for c in tried if effect in c.effects and set(c.effects) <= set(rung.effects)]
    added = max(1, len(rung.effects) - len(below.effects))
    return [
        c
        for c in tried
        if effect not in c.effects
        and len(c.effects) <= added
        and not any(alike(o.missed, c.missed, size) < settings.alike for o in own)
    ]


def _square(found: Rung | Confirmed, role: str) -> float:
    return found.scores[role].rmse ** 2
