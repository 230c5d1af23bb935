"""From the search to one of four verdicts, in words.

named            every chosen effect is needed, and nothing else explains it as well
undecided        one of them could be another effect, and these data cannot tell which
nothing_missing  nothing that counts is left that the motion could explain
unknown          something is left that the motion explains and the library does not
"""

from dataclasses import dataclass

import numpy as np

from spirob.diagnose.evidence import win_rates
from spirob.effects import Effect
from spirob.identify.problem import Effort
from spirob.machine.equivalence import equivalents
from spirob.machine.flexible import Ceiling, depends_on
from spirob.machine.search import Found, Model, Search, scores

LEAST_SHARE = 0.25  # of the squared residual that motion must explain to speak of a missing effect
REST = 0.1  # of what the named effects took away: so much may be left for the flexible residual
MOST_KEPT = 0.4  # of the squared held-out error: where more is left,
SOME_SHARE = 0.1  # and so much of it follows from the motion, the name is a guess
POOR = 0.3  # of the effort's RMS left after naming: no model to trust, whatever is left follows
SENSE = 0.3  # R² below which the effort does not follow from this motion


@dataclass(frozen=True)
class Judgement:
    """The verdict, and for each chosen effect its probability, equivalents and rivals."""

    kind: str
    probability: dict[str, float]
    equivalents: dict[str, list[str]]
    rivals: dict[str, list[str]]
    sentence: str
    explanation: str
    next_experiment: str


def judge(
    search: Search, found: Found, bare: Ceiling, rest: Ceiling, warnings: list[str]
) -> Judgement:
    """Judge a search; `bare` and `rest` are the ceilings over the bare and the chosen model.

    warnings  reasons not to trust a name: a number at its bound, an effort that ignores the motion
    """
    chosen, least = found.chosen, search.settings.floor * search.size
    same, rivals, probability = {}, {}, {}
    for effect in chosen.effects:
        others = found.rivals[effect.name()]
        same[effect.name()], rivals[effect.name()] = equivalents(chosen, others, least)
        contested = [
            m for m in others if next(iter(m.names - chosen.names)) in rivals[effect.name()]
        ]
        probability[effect.name()] = _probability(search, chosen, effect, contested)
    kind = _kind(search, found, bare, rest, rivals, bool(warnings))
    before = found.rungs[0]
    words = _Words(search, before, chosen, bare, rest, search.train.effort)
    sentence, explanation = words.say(kind, same, rivals, warnings)
    if found.vetoed:
        explanation += (
            f" {', '.join(_plain(n) for n in found.vetoed)} would lower the error on the training "
            "trials, but not on the held-out ones, and is not named."
        )
    experiment = _experiment(search, kind, chosen, rivals, found)
    return Judgement(kind, probability, same, rivals, sentence, explanation, experiment)


def senseless(search: Search, found: Found, rest: Ceiling) -> str:
    """A sentence where the effort does not follow from the motion at all; empty otherwise."""
    measured = search.train.measured()
    spread = float(np.var(measured))
    left = min(found.chosen.mean_square, float(np.mean(rest.left**2)))
    if spread > 0 and 1.0 - left / spread < SENSE:
        return (
            f"The motion explains only {max(0.0, 1 - left / spread):.0%} of the effort's variance, "
            "even with a flexible model: are the columns of two motors exchanged, or a unit wrong?"
        )
    return ""


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
    large = bool(np.sqrt(left) >= 2.0 * search.settings.floor * search.size)
    structured = large and rest.share > LEAST_SHARE
    if doubtful:
        return "unknown"
    if not found.chosen.effects:
        return "unknown" if structured else "nothing_missing"
    kept = found.chosen.heldout_square / max(found.rungs[0].heldout_square, 1e-300)
    if structured and left > REST * (before - after):
        return "unknown"
    poor = found.chosen.heldout_square > (POOR * search.size) ** 2
    follows = large and rest.share > SOME_SHARE
    # two of three: most of the error is kept, what is left is large, what is left has structure
    if (kept > MOST_KEPT) + poor + follows >= 2:
        return "unknown"
    return "undecided" if any(rivals.values()) else "named"


def _probability(search: Search, chosen: Model, effect: type[Effect], rivals: list[Model]) -> float:
    """How often the chosen effect wins against its rivals and its absence on resampled blocks.

    Blocks are those of the folds left out and of the held-out trials together.
    """
    without = search.tried[chosen.names - {effect.name()}]
    models = {"": without, effect.name(): chosen}
    models |= {next(iter(m.names - chosen.names)): m for m in rivals}
    errors = {n: np.concatenate([m.errors, m.heldout_errors]) for n, m in models.items()}
    return win_rates(errors, search.settings.seed)[effect.name()]


@dataclass(frozen=True)
class _Words:
    """Puts a verdict into sentences."""

    search: Search
    before: Model
    after: Model
    bare: Ceiling
    rest: Ceiling
    effort: Effort

    def say(
        self,
        kind: str,
        same: dict[str, list[str]],
        rivals: dict[str, list[str]],
        warnings: list[str],
    ) -> tuple[str, str]:
        if warnings:
            return "No verdict: the data or the model do not fit together.", " ".join(warnings)
        return getattr(self, f"_{kind}")(same, rivals)  # type: ignore[no-any-return]

    def _named(self, same: dict[str, list[str]], rivals: dict[str, list[str]]) -> tuple[str, str]:
        titles = [_with_equivalents(e, same[e.name()]) for e in self.after.effects]
        parts = [f"{e.signature} {e.explanation}" for e in self.after.effects]
        return f"Missing: {' and '.join(titles)}.", " ".join([*parts, self._fall(), self._left()])

    def _undecided(
        self, same: dict[str, list[str]], rivals: dict[str, list[str]]
    ) -> tuple[str, str]:
        sets = []
        for effect in self.after.effects:
            names = [effect.name(), *same[effect.name()], *rivals[effect.name()]]
            sets.append(" or ".join(_plain(n) for n in names))
        return (
            f"Undecided: {'; and '.join(sets)}.",
            f"Each of these explains the {self.effort.name} about as well on data that it was not "
            f"fitted to; these data cannot tell them apart. {self._fall()} {self._left()}",
        )

    def _nothing_missing(
        self, same: dict[str, list[str]], rivals: dict[str, list[str]]
    ) -> tuple[str, str]:
        return (
            f"Nothing is missing: the model is within {self._share(self.before):.1%} of the "
            f"{self.effort.name}.",
            "With fitted numbers alone no effect of the library lowers the error on data left out "
            f"by {self.search.settings.floor:.0%} of the {self.effort.name}'s RMS, and a flexible "
            f"model of the motion explains {self.bare.share:.0%} of the squared residual.",
        )

    def _unknown(self, same: dict[str, list[str]], rivals: dict[str, list[str]]) -> tuple[str, str]:
        partly = ", ".join(e.title for e in self.after.effects)
        more = (
            f" {partly} would explain a part of it, but more is left than it takes."
            if partly
            else ""
        )
        return (
            f"Something is missing that the library does not hold: it depends "
            f"{depends_on(self.rest)}.",
            f"The model misses {self._share(self.after):.1%} of the {self.effort.name}'s RMS on "
            f"data left out. A flexible model of the motion explains {self.rest.share:.0%} of that "
            f"squared error there; no effect of the library has its shape.{more}",
        )

    def _fall(self) -> str:
        before = scores(self.search, self.before)["test"].rmse
        after = scores(self.search, self.after)["test"].rmse
        size = float(np.sqrt(np.mean(self.search.heldout.measured() ** 2)))
        return (
            f"On held-out data the RMS error falls from {self.effort.shown(before, after)}, from "
            f"{before / size:.1%} to {after / size:.1%} of the {self.effort.name}'s RMS."
        )

    def _left(self) -> str:
        if self.rest.share < LEAST_SHARE:
            return "What is left does not follow from the motion."
        return (
            f"Of what is left, {self.rest.share:.0%} still follows from the motion: it depends "
            f"{depends_on(self.rest)}."
        )

    def _share(self, model: Model) -> float:
        return float(np.sqrt(model.mean_square)) / self.search.size


def _experiment(
    search: Search, kind: str, chosen: Model, rivals: dict[str, list[str]], found: Found
) -> str:
    if kind == "nothing_missing":
        return ""
    if kind == "unknown":
        return (
            "Repeat the trials at a second load and at half the speed, and look at the atlas again."
        )
    for effect in chosen.effects:
        for rival in rivals[effect.name()]:
            if rival in effect.tell_apart:
                return f"To decide: {effect.tell_apart[rival]}."
    if kind == "undecided":
        contested = [e for e in chosen.effects if rivals[e.name()]]
        return f"To decide: a trial with {contested[0].needs}."
    near = [o.effect.name() for o in found.offers[:6]]
    for effect in chosen.effects:
        for rival in near:
            if rival not in chosen.names and rival in effect.tell_apart:
                return f"To make sure: {effect.tell_apart[rival]}."
    return ""


def _with_equivalents(effect: type[Effect], same: list[str]) -> str:
    if not same:
        return effect.title
    return f"{effect.title} (on this rig the same as {' or '.join(_plain(n) for n in same)})"


def _plain(name: str) -> str:
    return name.replace("_", " ")
