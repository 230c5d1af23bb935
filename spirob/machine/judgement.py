"""From the search to one of four verdicts, in words.

named            a name that is more likely right than wrong; what is left beside it is said
undecided        one of them could be another effect, and these data cannot tell which
nothing_missing  nothing that counts is left that the motion could explain
unknown          something is missing, and no name for it is likely enough
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spirob.diagnosis.noise import noise_floor
from spirob.machine.certainty import figures, probability
from spirob.machine.equivalence import equivalents
from spirob.machine.flexible import Ceiling
from spirob.machine.search import Found, Search
from spirob.machine.wording import Words, experiment, plain

LEAST_SHARE = 0.25  # of the squared residual that motion must explain to speak of a missing effect
# of the effort's RMS, and times the noise: three quarters of the square are then no noise
MUCH, NOISY = 0.1, 2.0
LIKELY = 0.5  # a name is given where it is more likely right than wrong


@dataclass(frozen=True)
class Weighed:
    """A chosen effect: how likely its name is right, what says the same, what else it could be."""

    probability: float
    equivalents: list[str]
    rivals: list[str]
    figures: dict[str, float]


@dataclass(frozen=True)
class Judgement:
    """The verdict; `weighed` holds all chosen effects, those that are not named, too."""

    kind: str
    weighed: dict[str, Weighed]
    sentence: str
    explanation: str
    next_experiment: str


def weigh(search: Search, found: Found, rest: Ceiling) -> dict[str, Weighed]:
    """Each chosen effect by name; `rest` is the ceiling over the chosen model."""
    weighed = {}
    for effect in found.chosen.effects:
        others = found.rivals[effect.name()]
        same, rivals = equivalents(found.chosen, others, search.worth.least)
        shown = figures(search, found, rest, effect)
        weighed[effect.name()] = Weighed(probability(shown), same, rivals, shown)
    return weighed


def likely(weighed: Mapping[str, Weighed]) -> list[str]:
    """Names that are more likely right than wrong."""
    return [name for name, one in weighed.items() if one.probability >= LIKELY]


def judge(
    search: Search,
    found: Found,
    bare: Ceiling,
    rest: Ceiling,
    warnings: list[str],
    weighed: dict[str, Weighed],
) -> Judgement:
    """Judge a search; `bare` and `rest` are the ceilings over the bare and the chosen model.

    warnings  reasons not to trust a name: a number at its bound, an effort that ignores the motion
    """
    chosen = found.chosen
    own = {e.name(): weighed[e.name()] for e in chosen.effects}
    same = {name: one.equivalents for name, one in own.items()}
    rivals = {name: one.rivals for name, one in own.items()}
    kind = _kind(search, found, rest, own, bool(warnings))
    words = Words(search, found.rungs[0], chosen, bare, rest, search.train.effort)
    sentence, explanation = words.say(kind, same, rivals, warnings)
    if found.vetoed:
        explanation += (
            f" {', '.join(plain(n) for n in found.vetoed)} would lower the error on the training "
            "trials, but not on the held-out ones, and is not named."
        )
    unsure = {n: one for n, one in weighed.items() if one.probability < LIKELY}
    if unsure and not warnings:
        told = ", ".join(f"{plain(n)} ({one.probability:.0%})" for n, one in unsure.items())
        explanation += f" Too unlikely to be named, though it lowers the error: {told}."
    following = experiment(search, kind, chosen, rivals, found)
    return Judgement(kind, weighed, sentence, explanation, following)


def _kind(
    search: Search, found: Found, rest: Ceiling, weighed: Mapping[str, Weighed], doubtful: bool
) -> str:
    if doubtful:
        return "unknown"
    if not weighed:
        more = structured(search, found, rest) or _unexplained(search, found)
        return "unknown" if more else "nothing_missing"
    if not likely(weighed):
        return "unknown"
    return "undecided" if any(one.rivals for one in weighed.values()) else "named"


def structured(search: Search, found: Found, rest: Ceiling) -> bool:
    """Whether what is left still follows from the motion, by a share and a size that count."""
    large = np.sqrt(rest.share * found.chosen.mean_square) >= 2.0 * search.worth.least
    return bool(large) and rest.share > LEAST_SHARE


def _unexplained(search: Search, found: Found) -> bool:
    """Whether far more is left than any noise, though no signal of this moment explains it.

    Blows, chatter and memories do not follow from the motion of this moment.
    """
    noise = max(float(noise_floor(search.train)), search.worth.least)
    left = np.sqrt(found.chosen.heldout_square)
    return bool(left > max(MUCH * search.models.size, NOISY * noise))
