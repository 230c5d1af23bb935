"""From the search to one of four verdicts.

named            every effect that was added is more likely right than wrong
undecided        another effect that says something else wins too many of the draws
nothing_missing  the fitted model is complete
unknown          something is missing, and no name for it is likely enough

How likely a name is right was learned (`certainty`).  A name may stand although something is left
beside it; how much is said.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from spirob.diagnosis.certainty import LIKELY
from spirob.diagnosis.evidence import alike, complete, noise_floor
from spirob.diagnosis.figures import Weighed, weighed
from spirob.diagnosis.rungs import Confirmed, Ladder, Settings, label
from spirob.diagnosis.weighing import counts
from spirob.identify.problem import Effort, Problem, effort_rms

ATLAS = "The regimes that hold the error say what it depends on."
AGAIN = "Repeat the trials at a second load and at half the speed, and look at the atlas again."


@dataclass(frozen=True)
class Verdict:
    """What is missing.

    kind         "named", "undecided", "nothing_missing" or "unknown"
    probability  that the name is right, of several the least sure one's; 1 where nothing is
                 missing, 0 where nothing is named
    rivals       effects that explain the data as well in another way
    equivalents  effects that say the same of these data, under another name
    evidence     name of each added effect, named or not -> `probability` and `figures`
    sentence     one line;  explanation  a paragraph;  next_experiment  one line or empty
    """

    kind: str
    probability: float
    rivals: list[str]
    sentence: str
    explanation: str
    next_experiment: str
    equivalents: tuple[str, ...] = ()
    evidence: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    @property
    def contested(self) -> bool:
        """Whether another explanation stands beside what was found."""
        return self.kind == "undecided" or bool(self.equivalents)


def judge(search: Ladder, residuals: Mapping[str, Problem], settings: Settings) -> Verdict:
    """Judge the first round; later rounds are further rungs of the same answer.

    residuals  by role; the held-out trials say most of how likely a name is right
    """
    added = weighed(search, residuals, settings)
    evidence = {n: {"probability": w.probability, "figures": w.figures} for n, w in added.items()}
    return replace(_judged(search, residuals, settings, added), evidence=evidence)


def _judged(
    search: Ladder,
    residuals: Mapping[str, Problem],
    settings: Settings,
    added: Mapping[str, Weighed],
) -> Verdict:
    base, last, validate = search.rungs[0], search.rungs[-1], residuals["validate"]
    told = Told(search, settings, validate)
    if not added or min(w.probability for w in added.values()) < LIKELY:
        return told.nothing_or_unknown(added)
    first = search.rounds[0] if search.rounds else []
    best = _brought(search)
    alone = any(c is best for c in first)  # found in the first round
    passed = [c for c in first if c is not best and counts(c, base, residuals, settings)]
    size = float(np.sqrt(max(base.errors.mean() - best.errors.mean(), 1e-300)))
    same = [c for c in passed if alike(best.missed, c.missed, size) < settings.alike]
    # what holds the found and more was left for being hardly better: it is no other explanation
    more = [c for c in passed if c not in same and set(best.effects) < set(c.effects)]
    others = [c for c in passed if c not in [*same, *more]]
    rivals = [c for c in others if c.probability >= 1.0 - settings.confidence]
    sure = min(w.probability for w in added.values())
    # a rival counts in the first round; later it stands against what was named already
    if rivals and len(last.effects) == 1 and alone:
        return told.undecided(best, rivals, sure)
    return told.named(sure, same)


def _brought(search: Ladder) -> Confirmed:
    """The candidate that brought in the effects of the last rung, or the first of them."""
    last = search.rungs[-1].effects
    own = [c for tried in search.rounds for c in tried if set(c.effects) <= set(last)]
    return max(own, key=lambda c: c.probability)


def share_of(before: float, after: float, floor: float) -> float:
    """Of a mean square above that of the floor [RMS], what is gone."""
    return (before - after) / max(before - floor**2, 1e-300)


@dataclass(frozen=True)
class Told:
    """Puts a verdict into sentences."""

    search: Ladder
    settings: Settings
    validate: Problem

    @property
    def effort(self) -> Effort:
        """What the errors are of."""
        return self.validate.effort

    @property
    def share(self) -> float:
        """Of the effort, what the fitted numbers alone miss on trials that no fit has seen."""
        return self.search.rungs[0].scores["validate"].rmse / effort_rms(self.validate)

    @property
    def least(self) -> float:
        """The same of a complete model."""
        return complete(self.validate, self.settings.floor) / effort_rms(self.validate)

    def nothing_or_unknown(self, added: Mapping[str, Weighed]) -> Verdict:
        """The verdict where no name is likely enough."""
        return self._nothing(added) if self.share <= self.least else self._unknown(added)

    def _nothing(self, added: Mapping[str, Weighed]) -> Verdict:
        return Verdict(
            "nothing_missing",
            1.0,
            [],
            f"Nothing is missing: the model is within {self.share:.1%} of the {self.effort.name}.",
            f"With fitted numbers alone the model misses {self.share:.1%} of the "
            f"{self.effort.name}'s RMS on trials that it was not fitted to; sensor noise and the "
            f"differences between two builds of the same machine account for up to "
            f"{self.least:.1%}. No candidate that carries {self.settings.floor:.1%} of the "
            f"{self.effort.name} is likely.{_unlikely(added)}",
            "",
        )

    def _unknown(self, added: Mapping[str, Weighed]) -> Verdict:
        first = self.search.rounds[0] if self.search.rounds else []
        tried = ", ".join(e.title for c in first for e in c.effects)
        return Verdict(
            "unknown",
            0.0,
            [],
            f"Something is missing that the library does not hold: {self.share:.1%} of the "
            f"{self.effort.name}.",
            f"The model misses {self.share:.1%} of the {self.effort.name}'s RMS on trials that it "
            "was not fitted to, and no candidate explains enough of it to be likely (tried in full "
            f"simulation: {tried or 'none'}).{_unlikely(added)} {ATLAS}",
            AGAIN,
        )

    def named(self, sure: float, same: Sequence[Confirmed]) -> Verdict:
        """The verdict on what was added; `same` says as much of these data."""
        base, last = self.search.rungs[0], self.search.rungs[-1]
        before, after = base.scores["heldout"].rmse, last.scores["heldout"].rmse
        own, alone = set(last.effects), {c.effects for c in same}
        first = self.search.rounds[0]
        tried = dict.fromkeys(e for c in first if c.effects not in alone for e in c.effects)
        others = [e for e in tried if e not in own]
        ways = (
            e.tell_apart[o.name()] for e in last.effects for o in others if o.name() in e.tell_apart
        )
        experiment = next(ways, "")
        story = " ".join(f"{e.explanation} {e.signature}" for e in last.effects)
        effects = "the effect" if len(own) == 1 else "these effects"
        whole = self._accounted()
        beside = f" against {', '.join(e.title for e in others)}" if others else ""
        return Verdict(
            "named",
            sure,
            [],
            f"Missing: {' and '.join(e.title for e in last.effects)}.",
            f"{story} With fitted numbers alone the model misses {self.share:.1%} of the "
            f"{self.effort.name}'s RMS; with {effects} added and all numbers refitted, the error "
            f"on held-out trials falls from {self.effort.shown(before, after)}. It accounts for "
            f"{whole:.0%} of the squared error above the sensor's noise, and wins "
            f"{_brought(self.search).probability:.0%} of resampled errors{beside}.{self._left()}"
            f"{_alike(same)}",
            f"To make sure: {experiment}." if experiment else "",
            tuple(label(c.effects) for c in same),
        )

    def undecided(self, best: Confirmed, rivals: Sequence[Confirmed], sure: float) -> Verdict:
        """The verdict where another explains it about as well."""
        names = [e.name() for c in rivals for e in c.effects]
        titles = " or ".join(map(_titles, [best, *rivals]))
        known: Mapping[str, str] = {k: v for e in best.effects for k, v in e.tell_apart.items()}
        ways = [known[n] for n in names if n in known]
        return Verdict(
            "undecided",
            sure,
            names,
            f"Undecided: {titles}.",
            f"The model misses {self.share:.1%} of the {self.effort.name}'s RMS. Each of these "
            "explains it about as well on trials that it was not fitted to; these data cannot tell "
            f"them apart.{self._left()}",
            f"To decide: {ways[0]}." if ways else "Repeat the trials at a second load and speed.",
        )

    def _accounted(self) -> float:
        """Share of the squared validation error above the noise that the added effects explain."""
        before, after = (float(self.search.rungs[k].errors.mean()) for k in (0, -1))
        return float(np.clip(share_of(before, after, noise_floor(self.validate)), 0.0, 1.0))

    def _left(self) -> str:
        """What is left beside the added effects, where it is more than a complete model leaves."""
        left = self.search.rungs[-1].scores["validate"].rmse / effort_rms(self.validate)
        if left <= self.least:
            return ""
        return (
            f" Beside it {left:.1%} of the {self.effort.name} is left, more than the "
            f"{self.least:.1%} that noise and builds account for: something else is missing, too, "
            "or its law is not quite the machine's."
        )


def _unlikely(added: Mapping[str, Weighed]) -> str:
    if not added:
        return ""
    told = ", ".join(f"{n.replace('_', ' ')} ({w.probability:.0%})" for n, w in added.items())
    return f" Too unlikely to be named, though it lowers the error: {told}."


def _alike(same: Sequence[Confirmed]) -> str:
    return f" On these data {' or '.join(map(_titles, same))} would say the same." if same else ""


def _titles(found: Confirmed) -> str:
    return " and ".join(e.title for e in found.effects)
