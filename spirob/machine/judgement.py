"""From the search to one of four verdicts, in words: sentence, explanation, next experiment.

named            a name that is more likely right than wrong; what is left beside it is said
undecided        one of them could be another effect, and these data cannot tell which
nothing_missing  nothing that counts is left that the motion could explain
unknown          something is missing, and no name for it is likely enough
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from spirob.diagnosis.certainty import LIKELY, probability
from spirob.diagnosis.document import SENSELESS
from spirob.diagnosis.evidence import noise_floor
from spirob.diagnosis.flexible import share
from spirob.effects import Effect
from spirob.identify.problem import Effort
from spirob.machine.candidates import equivalents, is_dry
from spirob.machine.composed.free_curve import is_bent
from spirob.machine.figures import Ended, figures, kin
from spirob.machine.flexible import Ceiling, depends_on
from spirob.machine.models import Model
from spirob.machine.search import Found, Search

SOME = 0.25  # of what is left follows from the motion: worth a sentence


@dataclass(frozen=True)
class Words:
    """Puts a verdict into sentences.

    before, after  the bare model and the chosen one;  bare, rest  the ceilings over them
    """

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
        """The sentence and the explanation of a verdict of this kind."""
        if warnings:
            return SENSELESS, " ".join(warnings)
        return getattr(self, f"_{kind}")(same, rivals)  # type: ignore[no-any-return]

    def _named(self, same: dict[str, list[str]], rivals: dict[str, list[str]]) -> tuple[str, str]:
        titles = [_with_equivalents(e, same[e.name()]) for e in self.after.effects]
        parts = [f"{e.signature} {e.explanation}" for e in self.after.effects]
        return f"Missing: {' and '.join(titles)}.", " ".join([*parts, self._fall(), self._left()])

    def _undecided(
        self, same: dict[str, list[str]], rivals: dict[str, list[str]]
    ) -> tuple[str, str]:
        dry = {e.name() for e in (*self.search.candidates, *self.after.effects) if is_dry(e)}
        sets = []
        for effect in self.after.effects:
            names = [effect.name(), *same[effect.name()], *rivals[effect.name()]]
            told = " or ".join(plain(n) for n in names)
            only_dry = len(names) > 1 and dry.issuperset(names)
            sets.append(f"dry friction by one of its laws ({told})" if only_dry else told)
        return (
            f"Undecided: {'; and '.join(sets)}.",
            f"Each of these explains most of the same of the {self.effort.name}; these data cannot "
            f"tell them apart. {self._fall()} {self._left()}",
        )

    def _nothing_missing(
        self, same: dict[str, list[str]], rivals: dict[str, list[str]]
    ) -> tuple[str, str]:
        return (
            f"Nothing is missing: the model is within {self._share(self.before):.1%} of the "
            f"{self.effort.name}.",
            "No likely effect of the library lowers the error of the fitted numbers on data left "
            f"out by {self.search.worth.least / self.search.models.size:.1%} of the "
            f"{self.effort.name}'s RMS, and a flexible model of the motion explains "
            f"{self.bare.share:.0%} of the squared residual.",
        )

    def _unknown(self, same: dict[str, list[str]], rivals: dict[str, list[str]]) -> tuple[str, str]:
        if self.after.effects:
            partly = " and ".join(e.title for e in self.after.effects)
            return (
                f"Something is missing, and no name for it is likely enough; nearest: {partly}.",
                f"{self._fall()} {self._left()}",
            )
        if self._follows < SOME:
            return (
                "Something is missing that the library does not hold: it follows from no signal "
                "of the moment.",
                f"The model misses {self._share(self.after):.1%} of the {self.effort.name}'s RMS "
                "on data left out, far more than the sensors' noise, and neither position, speed, "
                "acceleration nor time explain it: blows, chatter or a memory would look so, and "
                "so would logs that do not belong together.",
            )
        return (
            f"Something is missing that the library does not hold: it depends "
            f"{depends_on(self.rest)}.",
            f"The model misses {self._share(self.after):.1%} of the {self.effort.name}'s RMS on "
            f"data left out. A flexible model of the motion explains {self._follows:.0%} of that "
            f"squared error there; no effect of the library has its shape.",
        )

    def _fall(self) -> str:
        before = self.search.models.scores(self.before)["test"].rmse
        after = self.search.models.scores(self.after)["test"].rmse
        size = float(np.sqrt(np.mean(self.search.heldout.measured() ** 2)))
        return (
            f"On held-out data the RMS error falls from {self.effort.shown(before, after)}, from "
            f"{before / size:.1%} to {after / size:.1%} of the {self.effort.name}'s RMS."
        )

    def _left(self) -> str:
        if self._follows < SOME:
            return "What is left hardly follows from the motion."
        return (
            f"Of what is left, {self._follows:.0%} of the square still follows from the motion: it "
            f"depends {depends_on(self.rest)}."
        )

    @property
    def _follows(self) -> float:
        """Share of what is left, squared, that a flexible model explains on data left out."""
        return max(self.rest.share, share(self.after.heldout, self.rest.heldout))

    def _share(self, model: Model) -> float:
        return float(np.sqrt(model.mean_square)) / self.search.models.size


def experiment(
    search: Search, kind: str, chosen: Model, rivals: dict[str, list[str]], found: Found
) -> str:
    """What to measure next, so that the verdict becomes surer."""
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
    return f"{effect.title} (on this rig the same as {' or '.join(plain(n) for n in same)})"


def plain(name: str) -> str:
    """An effect's name as words."""
    return name.replace("_", " ")


LEAST_SHARE = 0.25  # of the squared residual that motion must explain to speak of a missing effect
# of the effort's RMS, and times the noise: three quarters of the square are then no noise
MUCH, NOISY = 0.1, 2.0
TWICE = 2.0  # times the least effect: what counts where nothing names it


@dataclass(frozen=True)
class Weighed:
    """A chosen effect: how likely its name is right, what says the same, what else it could be.

    together  how likely it is right that this effect or one of its rivals is there
    """

    probability: float
    together: float
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


def weigh(ended: Ended) -> dict[str, Weighed]:
    """Each chosen effect by name.

    A law of dry friction whose level has visibly another shape over the speed is surely not it.
    """
    search, found = ended.search, ended.found
    bent = is_bent(search, found.chosen)
    weighed = {}
    for effect in found.chosen.effects:
        exchanged = found.rivals[effect.name()]
        same, rivals = equivalents(found.chosen, exchanged, search.worth.least)
        shown = figures(ended, effect)
        own = 0.0 if bent and is_dry(effect) else probability(shown)
        weighed[effect.name()] = Weighed(own, own, same, rivals, shown)
    if likely(weighed):
        return weighed
    return {e.name(): _with_kin(ended, e, weighed[e.name()]) for e in found.chosen.effects}


def _with_kin(ended: Ended, effect: type[Effect], one: Weighed) -> Weighed:
    """An effect that is too unlikely alone, with its kin where one of them is likely."""
    others = kin(ended.search, ended.found.chosen, effect) if one.probability else []
    together = probability(figures(ended, effect, others)) if others else 0.0
    if together < LIKELY:
        return one
    rivals = [*others, *(name for name in one.rivals if name not in others)]
    return replace(one, together=together, rivals=rivals)


def likely(weighed: Mapping[str, Weighed]) -> list[str]:
    """Names that are more likely right than wrong, alone or with those that say most of it."""
    return [name for name, one in weighed.items() if one.together >= LIKELY]


def judge(
    ended: Ended, bare: Ceiling, warnings: list[str], weighed: dict[str, Weighed]
) -> Judgement:
    """Judge a search; `bare` is the ceiling over the bare model.

    warnings  reasons not to trust a name: a number at its bound, an effort that ignores the motion
    """
    search, found = ended.search, ended.found
    chosen = found.chosen
    own = {e.name(): weighed[e.name()] for e in chosen.effects}
    same = {name: one.equivalents for name, one in own.items()}
    rivals = {name: one.rivals for name, one in own.items()}
    kind = _kind(search, found, bare, own, bool(warnings))
    words = Words(search, found.rungs[0], chosen, bare, ended.rest, search.train.effort)
    sentence, explanation = words.say(kind, same, rivals, warnings)
    if found.vetoed:
        explanation += (
            f" {', '.join(plain(n) for n in found.vetoed)} would lower the error on the training "
            "trials, but not on the held-out ones, and is not named."
        )
    unsure = {n: one for n, one in weighed.items() if one.together < LIKELY}
    if unsure and not warnings:
        told = ", ".join(f"{plain(n)} ({one.probability:.0%})" for n, one in unsure.items())
        explanation += f" Too unlikely to be named, though it lowers the error: {told}."
    following = experiment(search, kind, chosen, rivals, found)
    return Judgement(kind, weighed, sentence, explanation, following)


def _kind(
    search: Search, found: Found, bare: Ceiling, weighed: Mapping[str, Weighed], doubtful: bool
) -> str:
    if doubtful:
        return "unknown"
    if not likely(weighed):
        return "unknown" if _lacking(search, found, bare) else "nothing_missing"
    return "undecided" if any(one.rivals for one in weighed.values()) else "named"


def _lacking(search: Search, found: Found, bare: Ceiling) -> bool:
    """Whether the fitted numbers alone leave something that counts, though nothing names it."""
    model, least = found.rungs[0], TWICE * search.worth.least
    taken = model.mean_square - found.chosen.mean_square
    return taken >= least**2 or structured(search, model, bare) or _unexplained(search, model)


def structured(search: Search, model: Model, rest: Ceiling) -> bool:
    """Whether what a model leaves follows from the motion, by a share and a size that count."""
    large = np.sqrt(rest.share * model.mean_square) >= TWICE * search.worth.least
    return bool(large) and rest.share > LEAST_SHARE


def _unexplained(search: Search, model: Model) -> bool:
    """Whether far more is left than any noise, though no signal of this moment explains it.

    Blows, chatter and memories do not follow from the motion of this moment.
    """
    noise = max(float(noise_floor(search.train)), search.worth.least)
    left = np.sqrt(model.heldout_square)
    return bool(left > max(MUCH * search.models.size, NOISY * noise))
