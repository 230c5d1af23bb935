"""What the search on an arm shows of each effect that was added: the figures of `certainty`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spirob.diagnosis.certainty import probability, ratio, rounded, sharp
from spirob.diagnosis.evidence import alike, complete
from spirob.diagnosis.rungs import Confirmed, Ladder, Rung, Settings
from spirob.effects import Effect
from spirob.identify.problem import Problem

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

    What of an error on trials that no fit has seen follows from the motion, too few of them tell:
    it is what lies above a complete model's, as builds of the machine differ by that.
    """
    last, found = search.rungs[-1], {}
    least = complete(residuals["heldout"], settings.floor) ** 2
    for at, rung in enumerate(search.rungs[1:], 1):
        # what stands before it may be gone: then the round that began further below brought it in
        under = max(k for k in range(at) if set(search.rungs[k].effects) < set(rung.effects))
        below = search.rungs[under]
        tried = search.rounds[under] if under < len(search.rounds) else []
        for effect in rung.effects:
            if effect not in last.effects or effect in below.effects:
                continue
            before, after = _square(below), _square(rung)
            others = [_square(o) for o in _others(effect, below, rung, tried, settings)]
            told = {
                "fall_heldout": ratio(before, after),
                "ahead_heldout": ratio(min([before, *others]), after),
                "left": ratio(max(_square(last) - least, 0.0), max(before - after, 0.0)),
                "sharp": sharp(rung.fit, effect),
                "place": float(len(below.effects)),
                "late": 0.0,  # logs of the arm are put right before
            }
            found[effect.name()] = Weighed(rounded(told))
    return found


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


def _square(found: Rung | Confirmed) -> float:
    """Of the held-out error."""
    return found.scores["heldout"].rmse ** 2
