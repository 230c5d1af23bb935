"""From the search to one of four verdicts.

named            accounts for enough of the error and is sure enough
undecided        another effect that says something else wins too many of the draws
nothing_missing  the fitted model is complete
unknown          something is missing, and no name accounts for it or is sure enough
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spirob.diagnosis.evidence import alike, complete, noise_floor
from spirob.diagnosis.rungs import Confirmed, Ladder, Settings, label
from spirob.diagnosis.weighing import counts
from spirob.effects import Effect
from spirob.identify.problem import Effort, Problem, effort_rms

ATLAS = "The regimes that hold the error say what it depends on."
AGAIN = "Repeat the trials at a second load and at half the speed, and look at the atlas again."


@dataclass(frozen=True)
class Verdict:
    """What is missing.

    kind         "named", "undecided", "nothing_missing" or "unknown"
    probability  how often the named effect wins on resampled errors, times the share of the
                 squared error above the sensor's noise that it accounts for: a law that leaves
                 structure behind may stand for another, which the library does not hold
    rivals       effects that explain the data as well in another way
    equivalents  effects that say the same of these data, under another name
    accounted    share of the squared error above the sensor's noise that the named explain
    sentence     one line;  explanation  a paragraph;  next_experiment  one line or empty
    """

    kind: str
    probability: float
    rivals: list[str]
    sentence: str
    explanation: str
    next_experiment: str
    equivalents: tuple[str, ...] = ()
    accounted: float = 1.0

    @property
    def contested(self) -> bool:
        """Whether another explanation stands beside what was found."""
        return self.kind == "undecided" or bool(self.equivalents)


def judge(search: Ladder, residuals: Mapping[str, Problem], settings: Settings) -> Verdict:
    """Judge the first round; later rounds are further rungs of the same answer.

    residuals  by role; the held-out trials can only take a name away
    """
    base, last, validate = search.rungs[0], search.rungs[-1], residuals["validate"]
    effort, size = validate.effort, effort_rms(validate)
    share = base.scores["validate"].rmse / size
    first = search.rounds[0] if search.rounds else []
    enough = complete(validate, settings.floor)
    least = enough / size
    accounted = min(explained(search, enough), foretold(search, residuals["heldout"], settings))
    small = share <= least and accounted < settings.explained
    if not last.effects or small:
        return _nothing_or_unknown(share, least, settings, first, effort)
    if accounted < settings.explained:
        told = f"accounts for {accounted:.0%} of the squared error, too little to be its cause"
        return _poorly_explained(share, told, last.effects, effort)
    best = _brought(search)
    alone = any(c is best for c in first)  # found in the first round
    passed = [c for c in first if c is not best and counts(c, base, residuals, settings)]
    size = float(np.sqrt(max(base.errors.mean() - best.errors.mean(), 1e-300)))
    same = [c for c in passed if alike(best.missed, c.missed, size) < settings.alike]
    # what holds the found and more was left for being hardly better: it is no other explanation
    more = [c for c in passed if c not in same and set(best.effects) < set(c.effects)]
    if alone:  # the probabilities of another round are of other contests
        best = replace(best, probability=sum(c.probability for c in [best, *same, *more]))
    others = [c for c in passed if c not in [*same, *more]]
    rivals = [c for c in others if c.probability >= 1.0 - settings.confidence]
    # a rival counts in the first round; later it stands against what was named already
    if rivals and len(last.effects) == 1 and alone:
        return _undecided(best, rivals, share, effort)
    whole = float(np.clip(explained(search, noise_floor(validate)), 0.0, 1.0))
    # a complete model leaves no structure in which another law could be; how sure its name is said
    # to be stays cut, because another may do the same
    if (chance := best.probability * (1.0 if accounted >= 1.0 else whole)) < settings.sure:
        told = f"is right with a probability of {chance:.0%} only"
        return _poorly_explained(share, told, last.effects, effort)
    return _named(search, best, whole, same, share, effort)


def _brought(search: Ladder) -> Confirmed:
    """The candidate that brought in the effects of the last rung, or the first of them."""
    last = search.rungs[-1].effects
    own = [c for tried in search.rounds for c in tried if set(c.effects) <= set(last)]
    return max(own, key=lambda c: c.probability)


def explained(search: Ladder, floor: float) -> float:
    """Share of the squared validation error above the floor that the named effects account for.

    floor  RMS that noise and small differences between machine and model leave
    """
    before, after = (float(r.errors.mean()) for r in (search.rungs[0], search.rungs[-1]))
    return share_of(before, after, floor)


def foretold(search: Ladder, heldout: Problem, settings: Settings) -> float:
    """The same share on the held-out trials; all of it where the last rung is complete there.

    What was chosen for the validation trials may be what imitates the missing effect on them: a
    wave of free length passes for much, until it meets a stroke that it was not chosen for.
    """
    before, after = (r.scores["heldout"].rmse for r in (search.rungs[0], search.rungs[-1]))
    enough = complete(heldout, settings.floor)
    if after <= enough:
        return 1.0
    return share_of(before**2, after**2, enough)


def share_of(before: float, after: float, floor: float) -> float:
    """Of a mean square above that of the floor [RMS], what is gone."""
    return (before - after) / max(before - floor**2, 1e-300)


def _nothing_or_unknown(
    share: float, least: float, settings: Settings, first: Sequence[Confirmed], effort: Effort
) -> Verdict:
    tried = ", ".join(e.title for c in first for e in c.effects)
    if share <= least:
        return Verdict(
            "nothing_missing",
            1.0,
            [],
            f"Nothing is missing: the model is within {share:.1%} of the {effort.name}.",
            f"With fitted numbers alone the model misses {share:.1%} of the {effort.name}'s RMS on "
            f"trials that it was not fitted to; sensor noise and the differences between two "
            f"builds of the same machine account for up to {least:.1%}. No candidate carries "
            f"{settings.floor:.1%} of the {effort.name} and most of what is left.",
            "",
        )
    return Verdict(
        "unknown",
        0.0,
        [],
        f"Something is missing that the library does not hold: {share:.1%} of the {effort.name}.",
        f"The model misses {share:.1%} of the {effort.name}'s RMS on trials that it was not "
        "fitted to, and no candidate explains enough of it (tried in full simulation: "
        f"{tried or 'none'}). {ATLAS}",
        AGAIN,
    )


def _poorly_explained(
    share: float, told: str, effects: Sequence[type[Effect]], effort: Effort
) -> Verdict:
    best = " and ".join(e.title for e in effects)
    return Verdict(
        "unknown",
        0.0,
        [],
        f"Something is missing that the library does not hold: {share:.1%} of the {effort.name}.",
        f"The model misses {share:.1%} of the {effort.name}'s RMS on trials that it was not "
        f"fitted to. The best explanation, {best}, {told}. {ATLAS}",
        AGAIN,
    )


def _named(
    search: Ladder,
    best: Confirmed,
    whole: float,
    same: Sequence[Confirmed],
    share: float,
    effort: Effort,
) -> Verdict:
    base, last = search.rungs[0], search.rungs[-1]
    before, after = base.scores["heldout"].rmse, last.scores["heldout"].rmse
    own = set(last.effects)
    alone = {c.effects for c in same}
    tried = dict.fromkeys(e for c in search.rounds[0] if c.effects not in alone for e in c.effects)
    others = [e for e in tried if e not in own]
    ways = (
        e.tell_apart[o.name()] for e in last.effects for o in others if o.name() in e.tell_apart
    )
    experiment = next(ways, "")
    story = " ".join(f"{e.explanation} {e.signature}" for e in last.effects)
    added = "the effect" if len(own) == 1 else "these effects"
    return Verdict(
        "named",
        best.probability * whole,
        [],
        f"Missing: {' and '.join(e.title for e in last.effects)}.",
        f"{story} With fitted numbers alone the model misses "
        f"{share:.1%} of the {effort.name}'s RMS; with {added} added and all numbers refitted, "
        f"the error on held-out trials falls from {effort.shown(before, after)}. "
        f"It accounts for {whole:.0%} of the squared error above the sensor's noise, and wins "
        f"{best.probability:.0%} of resampled errors"
        + (f" against {', '.join(e.title for e in others)}." if others else ".")
        + (f" On these data {' or '.join(map(_titles, same))} would say the same." if same else ""),
        f"To make sure: {experiment}." if experiment else "",
        tuple(label(c.effects) for c in same),
        whole,
    )


def _titles(found: Confirmed) -> str:
    return " and ".join(e.title for e in found.effects)


def _undecided(
    best: Confirmed, rivals: Sequence[Confirmed], share: float, effort: Effort
) -> Verdict:
    names = [e.name() for c in rivals for e in c.effects]
    every = [best, *rivals]
    titles = " or ".join(map(_titles, every))
    known: Mapping[str, str] = {k: v for e in best.effects for k, v in e.tell_apart.items()}
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
