"""From the search to one of four verdicts, in words: sentence, explanation, next experiment.

named            a name that is more likely right than wrong; what is left beside it is said
undecided        one of them could be another effect, and these data cannot tell which
nothing_missing  nothing that counts is left that the model could explain
unknown          something is missing, and no name for it is likely enough
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spirob.diagnosis.certainty import LIKELY, Ended
from spirob.diagnosis.conclusion import Weighed, concluded, likely
from spirob.diagnosis.criteria import Criteria
from spirob.diagnosis.model import Model, Predictor, is_dry
from spirob.diagnosis.search import Search
from spirob.effects import Effect
from spirob.identify.problem import effort_rms

SENSELESS = "No verdict: the data or the model do not fit together."
ATLAS = "The regimes that hold the error say what it depends on."
AGAIN = "Repeat the trials at a second load and at half the speed, and look at the atlas again."
SAID = 0.005  # least probability that is no 0 % in words
TWICE = 2.0  # times the least effect: what counts where nothing names it


@dataclass(frozen=True)
class Verdict:
    """What is missing.

    kind      "named", "undecided", "nothing_missing" or "unknown"
    weighed   all chosen effects by name, those that are not named, too
    sentence  one line;  explanation  a paragraph;  next_experiment  one line or empty
    doubts    why no name can be trusted whatever the errors say, a sentence each
    """

    kind: str
    weighed: Mapping[str, Weighed]
    sentence: str
    explanation: str
    next_experiment: str
    doubts: tuple[str, ...] = ()

    @property
    def named(self) -> list[str]:
        """Names of the effects that the model gets; of an undecided verdict none."""
        return likely(self.weighed) if self.kind == "named" else []

    @property
    def probability(self) -> float:
        """That the names are right, of several the least sure one's; 1 where nothing is missing."""
        if self.kind == "nothing_missing":
            return 1.0
        if self.kind == "unknown":
            return 0.0
        return min(self.weighed[name].probability for name in likely(self.weighed))

    @property
    def rivals(self) -> list[str]:
        """Effects that explain it as well in another way."""
        return sorted({n for one in self.weighed.values() for n in one.rivals})

    @property
    def equivalents(self) -> list[str]:
        """Effects that say the same of these data, under another name."""
        return sorted({n for one in self.weighed.values() for n in one.equivalents})

    @property
    def contested(self) -> bool:
        """Whether another explanation stands beside what was found."""
        return self.kind == "undecided" or (self.kind == "named" and bool(self.equivalents))


def searched(
    models: Predictor,
    candidates: Sequence[type[Effect]],
    criteria: Criteria,
    progress: Callable[[str], None] = lambda text: None,
    doubts: Sequence[str] = (),
) -> tuple[Ended, Verdict]:
    """Search, conclude and judge: what pipeline, trial and an arm from elsewhere run alike."""
    search = Search(models, candidates, criteria, progress)
    ended, weighed = concluded(search, search.run())
    return ended, judge(ended, weighed, doubts)


def judge(
    ended: Ended, weighed: Mapping[str, Weighed], doubts: Sequence[str] = (), lacking: bool = False
) -> Verdict:
    """The verdict on a search.

    doubts   reasons not to trust a name, a sentence each
    lacking  whether something is known to be missing that no name explains
    """
    found = ended.found
    words = Words(ended, weighed)
    kind = "unknown" if doubts or lacking else _kind(ended, weighed)
    sentence, explanation = (SENSELESS, " ".join(doubts)) if doubts else words.say(kind)
    if vetoed := [name for name in found.vetoed if not _lowers(ended, name)]:
        explanation += (
            f" Not named, as more is left of the held-out trials than by what was chosen, though "
            f"it lowers the error on the training trials: {', '.join(plain(n) for n in vetoed)}."
        )
    unsure = {n: one for n, one in weighed.items() if one.together < LIKELY}
    if unsure and not doubts:
        told = ", ".join(f"{plain(n)} ({one.probability:.0%})" for n, one in unsure.items())
        explanation += f" Too unlikely to be named, though it lowers the error: {told}."
    following = words.experiment(kind)
    return Verdict(kind, dict(weighed), sentence, explanation, following, tuple(doubts))


def _lowers(ended: Ended, name: str) -> bool:
    """Whether some model with an effect leaves less of the held-out trials than the chosen one."""
    chosen = ended.found.chosen.heldout_square
    tried = ended.search.models.tried.values()
    return any(m.heldout_square < chosen for m in tried if name in m.names)


def _kind(ended: Ended, weighed: Mapping[str, Weighed]) -> str:
    if not likely(weighed):
        return "unknown" if _lacking(ended) else "nothing_missing"
    chosen = [weighed[e.name()] for e in ended.found.chosen.effects]
    return "undecided" if any(one.rivals for one in chosen) else "named"


def _lacking(ended: Ended) -> bool:
    """Whether the fitted numbers alone leave something that counts, though nothing names it."""
    bare, least = ended.found.rungs[0], TWICE * ended.search.worth.least
    taken = bare.mean_square - ended.found.chosen.mean_square
    return taken >= least**2 or ended.search.models.lacks(bare)


@dataclass(frozen=True)
class Words:
    """Puts a verdict into sentences."""

    ended: Ended
    weighed: Mapping[str, Weighed]

    def say(self, kind: str) -> tuple[str, str]:
        """The sentence and the explanation of a verdict of this kind."""
        return getattr(self, f"_{kind}")()  # type: ignore[no-any-return]

    @property
    def _chosen(self) -> Model:
        return self.ended.found.chosen

    @property
    def _effort(self) -> str:
        return self.ended.search.models.train.effort.name  # type: ignore[no-any-return]

    def _named(self) -> tuple[str, str]:
        titles, causes = self._plain(self._chosen.effects)
        return f"Missing: {titles}.", f"{causes} {self._fall_and_left()}"

    def _undecided(self) -> tuple[str, str]:
        chosen = self._chosen.effects
        plain_ones = [e for e in chosen if not self.weighed[e.name()].rivals]
        titles, causes = self._plain(plain_ones)
        sets = "; and ".join(self._one_of(e) for e in chosen if e not in plain_ones)
        beside = "Undecided" if not plain_ones else f"Missing: {titles}. Undecided beside it"
        return (
            f"{beside}: {sets}.",
            f"{causes} Each of those between which it is undecided explains most of the same of "
            f"the {self._effort}; these data cannot tell them apart. "
            f"{self._fall_and_left()}".lstrip(),
        )

    def _plain(self, effects: Sequence[type[Effect]]) -> tuple[str, str]:
        """Titles of effects, with what says the same; and what each does."""
        titles = [_with_equivalents(e, self.weighed[e.name()].equivalents) for e in effects]
        return " and ".join(titles), " ".join(f"{e.signature} {e.explanation}" for e in effects)

    def _one_of(self, effect: type[Effect]) -> str:
        """An effect and what it may be instead."""
        candidates = (*self.ended.search.candidates, *self._chosen.effects)
        one, dry = self.weighed[effect.name()], {e.name() for e in candidates if is_dry(e)}
        names = [effect.name(), *one.equivalents, *one.rivals]
        told = " or ".join(plain(n) for n in names)
        return f"dry friction by one of its laws ({told})" if dry.issuperset(names) else told

    def _nothing_missing(self) -> tuple[str, str]:
        models, bare = self.ended.search.models, self.ended.found.rungs[0]
        share = float(np.sqrt(bare.mean_square)) / models.size
        held = float(np.sqrt(bare.heldout_square)) / effort_rms(models.heldout)
        more = f", {held:.1%} of that held out" if held > TWICE * share else ""
        told = f"{share:.1%} of the {self._effort} is left{more}"
        return f"Nothing is missing that these data show: {told}.", models.nothing(bare)

    def _unknown(self) -> tuple[str, str]:
        if not self._chosen.effects:
            return self.ended.left.unknown
        sure = {e.title: self.weighed[e.name()].probability for e in self._chosen.effects}
        partly = " and ".join(f"{title} with {p:.0%}" for title, p in sure.items() if p >= SAID)
        nearest = f"; nearest: {partly}" if partly else ""
        return (
            f"Something is missing, and no name for it is likely enough{nearest}.",
            self._fall_and_left(),
        )

    def _fall_and_left(self) -> str:
        models, bare = self.ended.search.models, self.ended.found.rungs[0]
        before, after = (float(np.sqrt(m.heldout_square)) for m in (bare, self._chosen))
        size = effort_rms(models.heldout)
        way = "rises" if after > before else "falls"
        fall = (
            f"On held-out data the RMS error {way} from "
            f"{models.train.effort.shown(before, after)}, from {before / size:.1%} to "
            f"{after / size:.1%} of the {self._effort}'s RMS."
        )
        return " ".join(text for text in (fall, self.ended.left.said) if text)

    def experiment(self, kind: str) -> str:
        """What to measure next, so that the verdict becomes surer."""
        if kind in ("nothing_missing", "unknown"):
            return AGAIN if kind == "unknown" else ""
        chosen = [(e, self.weighed[e.name()].rivals) for e in self._chosen.effects]
        for effect, rivals in chosen:
            for rival in rivals:
                if rival in effect.tell_apart:
                    return f"To decide: {effect.tell_apart[rival]}."
        if kind == "undecided":
            contested = [effect for effect, rivals in chosen if rivals]
            return f"To decide: a trial with {contested[0].needs}."
        near = [o.effect.name() for o in self.ended.found.offers[:6]]
        for effect, _ in chosen:
            for rival in near:
                if rival not in self._chosen.names and rival in effect.tell_apart:
                    return f"To make sure: {effect.tell_apart[rival]}."
        return ""


def _with_equivalents(effect: type[Effect], same: Sequence[str]) -> str:
    if not same:
        return effect.title
    return f"{effect.title} (on this rig the same as {' or '.join(plain(n) for n in same)})"


def plain(name: str) -> str:
    """An effect's name as words."""
    return name.replace("_", " ")
