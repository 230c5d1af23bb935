"""From the search to one of four verdicts, in words.

named            every chosen effect is needed, and nothing else explains it as well
undecided        one of them could be another effect, and these data cannot tell which
nothing_missing  nothing that counts is left that the motion could explain
unknown          something is left that the motion explains and the library does not
"""

from dataclasses import dataclass

import numpy as np

from spirob.diagnosis.evidence import win_rates
from spirob.diagnosis.noise import noise_floor
from spirob.effects import Effect
from spirob.machine.certainty import figures
from spirob.machine.equivalence import equivalents
from spirob.machine.flexible import Ceiling
from spirob.machine.models import Model
from spirob.machine.search import Found, Search
from spirob.machine.wording import Words, experiment, plain

LEAST_SHARE = 0.25  # of the squared residual that motion must explain to speak of a missing effect
REST = 0.1  # of what the named effects took away: so much may be left for the flexible residual
MOST_KEPT = 0.4  # of the squared held-out error: where more is left,
SOME_SHARE = 0.1  # and so much of it follows from the motion, the name is a guess
MUCH, NOISY = 0.1, 4.0  # of the effort's RMS, and times the noise: no noise leaves so much
POOR = 0.2  # of the effort's RMS left after naming: no model to trust, whatever is left follows


@dataclass(frozen=True)
class Judgement:
    """The verdict, and for each chosen effect its probability, equivalents, rivals and figures."""

    kind: str
    probability: dict[str, float]
    equivalents: dict[str, list[str]]
    rivals: dict[str, list[str]]
    figures: dict[str, dict[str, float]]
    sentence: str
    explanation: str
    next_experiment: str


def judge(
    search: Search, found: Found, bare: Ceiling, rest: Ceiling, warnings: list[str]
) -> Judgement:
    """Judge a search; `bare` and `rest` are the ceilings over the bare and the chosen model.

    warnings  reasons not to trust a name: a number at its bound, an effort that ignores the motion
    """
    chosen, least = found.chosen, search.worth.least
    same, rivals, probability, shown = {}, {}, {}, {}
    for effect in chosen.effects:
        others = found.rivals[effect.name()]
        same[effect.name()], rivals[effect.name()] = equivalents(chosen, others, least)
        contested = [
            m for m in others if next(iter(m.names - chosen.names)) in rivals[effect.name()]
        ]
        wins = _probability(search, chosen, effect, contested)
        probability[effect.name()] = wins
        shown[effect.name()] = figures(search, found, rest, effect, wins, len(warnings))
    kind = _kind(search, found, bare, rest, rivals, bool(warnings))
    before = found.rungs[0]
    words = Words(search, before, chosen, bare, rest, search.train.effort)
    sentence, explanation = words.say(kind, same, rivals, warnings)
    if found.vetoed:
        explanation += (
            f" {', '.join(plain(n) for n in found.vetoed)} would lower the error on the training "
            "trials, but not on the held-out ones, and is not named."
        )
    following = experiment(search, kind, chosen, rivals, found)
    return Judgement(kind, probability, same, rivals, shown, sentence, explanation, following)


def _kind(
    search: Search,
    found: Found,
    bare: Ceiling,
    rest: Ceiling,
    rivals: dict[str, list[str]],
    doubtful: bool,
) -> str:
    before, after = found.rungs[0].mean_square, found.chosen.mean_square
    left = rest.share * after
    large = bool(np.sqrt(left) >= 2.0 * search.worth.least)
    structured = large and rest.share > LEAST_SHARE
    if doubtful:
        return "unknown"
    if not found.chosen.effects:
        return "unknown" if structured or _unexplained(search, found) else "nothing_missing"
    kept = found.chosen.heldout_square / max(found.rungs[0].heldout_square, 1e-300)
    if structured and left > REST * (before - after):
        return "unknown"
    poor = found.chosen.heldout_square > (POOR * search.models.size) ** 2
    follows = large and rest.share > SOME_SHARE
    # two of three: most of the error is kept, what is left is large, what is left has structure
    if (kept > MOST_KEPT) + poor + follows >= 2:
        return "unknown"
    return "undecided" if any(rivals.values()) else "named"


def _unexplained(search: Search, found: Found) -> bool:
    """Whether far more is left than any noise, though no signal of this moment explains it.

    Blows, chatter and memories do not follow from the motion of this moment.
    """
    noise = max(float(noise_floor(search.train)), search.worth.least)
    left = np.sqrt(found.chosen.heldout_square)
    return bool(left > max(MUCH * search.models.size, NOISY * noise))


def _probability(search: Search, chosen: Model, effect: type[Effect], rivals: list[Model]) -> float:
    """How often the chosen effect wins against its rivals and its absence on resampled blocks.

    Blocks are those of the folds left out and of the held-out trials together.
    """
    without = search.models.tried[chosen.names - {effect.name()}]
    models = {"": without, effect.name(): chosen}
    models |= {next(iter(m.names - chosen.names)): m for m in rivals}
    errors = {n: np.concatenate([m.errors, m.heldout_errors]) for n, m in models.items()}
    return win_rates(errors, search.settings.seed)[effect.name()]
