"""From the search to a verdict: named, undecided, nothing missing, or unknown."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spirob.diagnose.ladder import Confirmed, Search, Settings, counts
from spirob.identify.problem import Effort, Problem


@dataclass(frozen=True)
class Verdict:
    """What is missing.

    kind         "named", "undecided", "nothing_missing" or "unknown"
    probability  how often the named effect wins on resampled validation errors
    rivals       effects that these data cannot tell from it
    sentence     one line;  explanation  a paragraph;  next_experiment  one line or empty
    """

    kind: str
    probability: float
    rivals: list[str]
    sentence: str
    explanation: str
    next_experiment: str


def judge(search: Search, validate: Problem, settings: Settings) -> Verdict:
    """Judge the first round; later rounds are further rungs of the same answer."""
    base = search.rungs[0]
    effort = validate.effort
    share = base.scores["validate"].rmse / float(np.sqrt(np.mean(validate.measured() ** 2)))
    first = search.rounds[0] if search.rounds else []
    passed = [c for c in first if counts(c, base, validate, settings)]
    if not passed:
        return _nothing_or_unknown(share, settings, first, effort)
    best = passed[0]
    if best.probability >= settings.confidence:
        return _named(search, best, share, effort)
    rivals = [c for c in passed if c.probability >= 1.0 - settings.confidence]
    return _undecided(best, rivals, share, effort)


def _nothing_or_unknown(
    share: float, settings: Settings, first: Sequence[Confirmed], effort: Effort
) -> Verdict:
    floor = 2.0 * settings.floor
    tried = ", ".join(c.effect.title for c in first)
    if share <= floor:
        return Verdict(
            "nothing_missing",
            1.0,
            [],
            f"Nothing is missing: the model is within {share:.1%} of the {effort.name}.",
            f"With fitted numbers alone the model misses {share:.1%} of the {effort.name}'s RMS on "
            f"trials that it was not fitted to; below {floor:.0%} the differences between two "
            f"builds of the same machine are as large as a missing effect. No candidate carries "
            f"{settings.floor:.1%} of the {effort.name}.",
            "",
        )
    return Verdict(
        "unknown",
        0.0,
        [],
        f"Something is missing that the library does not hold: {share:.1%} of the {effort.name}.",
        f"The model misses {share:.1%} of the {effort.name}'s RMS on trials that it was not "
        "fitted to, and no candidate explains enough of it (tried in full simulation: "
        f"{tried or 'none'}). "
        "The regimes that hold the error say what it depends on.",
        "Repeat the trials at a second load and at half the speed, and look at the atlas again.",
    )


def _named(search: Search, best: Confirmed, share: float, effort: Effort) -> Verdict:
    effect, base = best.effect, search.rungs[0]
    named = search.rungs[1] if len(search.rungs) > 1 else base
    before, after = base.scores["heldout"].rmse, named.scores["heldout"].rmse
    others = [c.effect.name() for c in search.rounds[0] if c is not best]
    experiment = next((effect.tell_apart[o] for o in others if o in effect.tell_apart), "")
    return Verdict(
        "named",
        best.probability,
        [],
        f"Missing: {effect.title}.",
        f"{effect.explanation} {effect.signature} With fitted numbers alone the model misses "
        f"{share:.1%} of the {effort.name}'s RMS; with the effect added and all numbers refitted, "
        f"the error on held-out trials falls from {effort.shown(before, after)}. "
        f"It wins {best.probability:.0%} of resampled validation errors"
        + (f" against {', '.join(others)}." if others else "."),
        f"To make sure: {experiment}." if experiment else "",
    )


def _undecided(
    best: Confirmed, rivals: Sequence[Confirmed], share: float, effort: Effort
) -> Verdict:
    names = [c.effect.name() for c in rivals if c is not best]
    titles = " or ".join([best.effect.title, *(c.effect.title for c in rivals if c is not best)])
    known: Mapping[str, str] = best.effect.tell_apart
    ways = [known[n] for n in names if n in known]
    return Verdict(
        "undecided",
        best.probability,
        names,
        f"Undecided: {titles}.",
        f"The model misses {share:.1%} of the {effort.name}'s RMS. Each of these explains it about "
        "as well on trials that it was not fitted to; these data cannot tell them apart.",
        f"To decide: {ways[0]}." if ways else "Repeat the trials at a second load and speed.",
    )
