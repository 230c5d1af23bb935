"""The search for the set of missing effects: joint additions, backward steps, exchanges.

Every set is fitted in full (`models`) and has to pass the questions of `criteria`; the held-out
trials can only veto.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from spirob.effects import Effect
from spirob.machine.candidates import is_dry, related, same_wave
from spirob.machine.criteria import Criteria, Worth
from spirob.machine.delays import only_aligns
from spirob.machine.filtering import noise_in_effort
from spirob.machine.inverse import InverseProblem
from spirob.machine.models import Model, Models, label
from spirob.machine.screening import ABSORBED, Offer, Screening
from spirob.progress import Steps

SINGLES, PAIRS, EXCHANGES = 4, 3, 3  # finalists of a round, fitted in full
EACH = 2 + EXCHANGES  # steps for an effect of a set: without it, what then is missing, exchanges
CEILINGS = 2  # over the bare and the chosen model
IMITATED = 0.5  # of what an effect explains: with more structure left, it stands for another


@dataclass
class Found:
    """What the search ends with.

    rungs   from the bare model to the chosen one, an effect at a time
    offers  all candidates screened beside the bare model, best first
    rivals  chosen effect -> models in which another takes its place about as well
    vetoed  effects that the left-out folds wanted and the held-out trials did not
    """

    rungs: list[Model]
    offers: list[Offer]
    rivals: dict[str, list[Model]] = field(default_factory=dict)
    vetoed: list[str] = field(default_factory=list)

    @property
    def chosen(self) -> Model:
        """The model that the search stands by."""
        return self.rungs[-1]


class Search:
    """Grows, prunes and exchanges sets of effects."""

    def __init__(
        self,
        train: InverseProblem,
        heldout: InverseProblem,
        names: Sequence[str],
        candidates: Sequence[type[Effect]],
        settings: Criteria,
        progress: Callable[[str], None] = lambda text: None,
    ):
        self.train, self.heldout = train, heldout
        self.progress = Steps(progress, _steps(0, settings.most))
        self.models = Models(train, heldout, names, self.progress)
        self.candidates, self.settings = list(candidates), settings
        self.worth = Worth(settings, self._least())
        self.vetoed: set[str] = set()
        self._screened: dict[frozenset[str], Screening] = {}

    def run(self) -> Found:
        """Search from the bare model."""
        bare = self.models.fitted((), {})
        current, offers = bare, self._screen(bare, self.candidates)
        # what the fitted numbers can say themselves is no effect, whatever is added later
        possible = {o.effect.name() for o in offers}
        self.candidates = [e for e in self.candidates if e.name() in possible]
        first, seen = offers, {current.names}
        while len(current.effects) < self.settings.most:
            grown = self._grown(current, offers)
            if grown is None:
                break
            kept = self._pruned(grown)
            if kept.names == current.names or kept.mean_square >= current.mean_square:
                break
            current = self._exchanged(kept)
            if current.names in seen:  # an exchange for a simpler effect may lead back
                break
            seen.add(current.names)
            self.progress(f"chosen so far: {label(current.effects)}")
            self.progress.expect(_steps(len(current.effects), self.settings.most))
            offers = self._screen(current, self.absent(current))
        self.progress.expect(_last(len(current.effects)))
        return self._found(self._pruned(current, whole=True), first)

    def extended(
        self,
        effects: tuple[type[Effect], ...],
        start: Mapping[str, float],
        others: Sequence[type[Effect]],
    ) -> list[Model]:
        """Models of a set with each of the others that could matter beside it."""
        current = self.models.fitted(effects, start)
        offers = [o for o in self._screen(current, others) if self.worth.possible(current, o.error)]
        return [
            self.models.fitted((*effects, o.effect), current.fit.changes | dict(o.values))
            for o in offers
        ]

    def without_imitations(self, found: Found, share: float) -> Found | None:
        """The same without its least effect, where more structure is left than that explains.

        A law that is not quite the machine's leaves structure behind, and a second law takes some
        of it: as long as more is left than it took, it stands for something else.  The first effect
        stays; what is left beside it, the verdict has to weigh.

        share  of the squared residual of the chosen model that still follows from the motion
        """
        chosen = found.chosen
        if len(chosen.effects) < 2:
            return None
        lesser = min(
            (self._without(chosen, e) for e in chosen.effects), key=lambda m: m.mean_square
        )
        fall = lesser.mean_square - chosen.mean_square
        if share * chosen.mean_square < max(IMITATED * fall, self.worth.least**2):
            return None
        return self._found(self._pruned(lesser, whole=True), found.offers)

    def narrowed(self, found: Found, names: Sequence[str]) -> Found:
        """The same with some of the chosen effects alone; their rivals stay what they were."""
        chosen = found.chosen
        effects = tuple(e for e in chosen.effects if e.name() in names)
        model = self.models.fitted(effects, chosen.fit.changes)
        rivals = {name: found.rivals[name] for name in names}
        return Found(self._rungs(model), found.offers, rivals, found.vetoed)

    def _found(self, chosen: Model, offers: list[Offer]) -> Found:
        found = Found(self._rungs(chosen), offers)
        found.rivals = {e.name(): self._rivals(chosen, e) for e in chosen.effects}
        found.vetoed = sorted(self.vetoed - chosen.names)
        return found

    def _least(self) -> float:
        """The least size of an effect: a share of the effort, or the noise of the motion in it."""
        bare = self.models.fitted((), {})
        modelled = self.train.measured() + bare.fit.residual
        squares = [p.noise**2 for r in self.train.recordings for p in r.pieces]
        noise = float(np.sqrt(np.mean(squares)))
        passed = noise_in_effort(noise, modelled, self.train.signals()["acceleration"])
        return max(self.settings.floor * self.models.size, passed)

    def absent(self, model: Model) -> list[type[Effect]]:
        """Candidates that may be added to a model."""
        out = model.names | self.vetoed
        return [e for e in self.candidates if e.name() not in out and not related(e, model.effects)]

    def _screen(self, model: Model, effects: Sequence[type[Effect]]) -> list[Offer]:
        if model.names not in self._screened:
            made = Screening(self.train, model.fit, self.models.folds)
            self._screened[model.names] = made
        screening = self._screened[model.names]
        if new := screening.untried(effects):
            self.progress(f"{len(new)} effects screened beside {label(model.effects)}")
        offers = screening.offers(effects)
        return [o for o in offers if o.new > ABSORBED]

    def _grown(self, current: Model, offers: Sequence[Offer]) -> Model | None:
        """The best addition of one effect or of two, None where none matters."""
        space = self.settings.most - len(current.effects)
        singles = [(o,) for o in offers[:SINGLES] if self.worth.possible(current, o.error)]
        best = self._best_of(current, singles)
        if best is not None or space < 2:
            return best
        # two true effects may each raise the error alone and lower it together
        pairs = self._screened[current.names].pairs(offers)
        pairs = [p for p in pairs if not related(p[1].effect, [p[2].effect])]
        return self._best_of(
            current,
            [(a, b) for error, a, b in pairs[:PAIRS] if self.worth.possible(current, error)],
        )

    def _best_of(self, current: Model, sets: Sequence[tuple[Offer, ...]]) -> Model | None:
        """Fit each extension in full and take the simplest of the good ones."""
        grown = []
        for chosen in sets:
            start = dict(current.fit.changes)
            for offer in chosen:
                start |= offer.values
            added = (*current.effects, *(offer.effect for offer in chosen))
            grown.append(self.models.fitted(added, start))
        passed = [m for m in grown if self._plain(m) and self.worth.matters(current, m)]
        return self.worth.simplest(passed) if passed else None

    def _without(self, model: Model, effect: type[Effect]) -> Model:
        rest = tuple(e for e in model.effects if e is not effect)
        return self.models.fitted(rest, model.fit.changes)

    def _pruned(self, model: Model, whole: bool = False) -> Model:
        """Backward elimination: every effect has to matter in the presence of the others.

        whole  nothing more will be added: until then what is still missing may hide an effect on
               the held-out trials, which deny it only where they contradict it
        """
        while model.effects:
            lesser = {e: self._without(model, e) for e in model.effects}
            weak = [e for e in model.effects if not self.worth.matters(lesser[e], model)]
            denied = [e for e in model.effects if self.worth.denied(lesser[e], model, whole)]
            self.vetoed |= {e.name() for e in denied if e not in weak}
            if not weak and not denied:
                return model
            model = min((lesser[e] for e in weak or denied), key=lambda m: m.mean_square)
        return model

    def _exchanged(self, model: Model) -> Model:
        """Exchange effects for better or simpler ones until none is left."""
        for _ in range(self.settings.most):
            others = [m for e in model.effects for m in self._exchanges(model, e)]
            chosen = self.worth.simplest([model, *others])
            if chosen is model:
                return model
            model = chosen
        return model

    def _exchanges(self, model: Model, effect: type[Effect]) -> list[Model]:
        """Models with another effect in the place of this one."""
        lesser = self._without(model, effect)
        offers = [o for o in self._screen(lesser, self.absent(lesser)) if o.effect is not effect][
            :EXCHANGES
        ]
        made = []
        for offer in offers:
            start = {**lesser.fit.changes, **offer.values}
            effects = tuple(offer.effect if e is effect else e for e in model.effects)
            if len({e.name() for e in effects}) == len(effects):
                made.append(self.models.fitted(effects, start))
        return [m for m in made if self._plain(m)]

    def _plain(self, model: Model) -> bool:
        """Whether a model says something that no simpler words would."""
        period = max(r.period for r in self.train.recordings)
        return not same_wave(model, self.train.sizes) and not only_aligns(
            model, self.train.rig, period
        )

    def _rivals(self, model: Model, effect: type[Effect]) -> list[Model]:
        """Exchanges that are neither richer nor clearly worse."""
        others = self._exchanges(model, effect)
        poorer = [
            m for m in others if m.numbers <= model.numbers and not self.worth.clearly(m, model)
        ]
        return [*poorer, *self._richer(model, effect)]

    def _richer(self, model: Model, effect: type[Effect]) -> list[Model]:
        """Models with another law of dry friction that halve what is left, though it is small.

        What they gain is too little to name them by, and too much to be sure of the simpler law.
        """
        made = []
        for other in self.candidates if is_dry(effect) else ():
            if not is_dry(other) or other.name() in model.names:
                continue
            rest = tuple(e for e in model.effects if e is not effect)
            kept = model.effects if not related(other, model.effects) else rest
            if not related(other, kept):
                made.append(self.models.fitted((*kept, other), model.fit.changes))
        return [m for m in made if self._plain(m) and self.worth.halves(model, m)]

    def _rungs(self, model: Model) -> list[Model]:
        """From the bare model upward, each time the effect that takes most off the error."""
        rungs, left = [self.models.fitted((), {})], list(model.effects)
        while left:
            tried = {
                e: self.models.fitted((*rungs[-1].effects, e), model.fit.changes)
                if len(left) > 1
                else model
                for e in left
            }
            effect = min(tried, key=lambda e: tried[e].mean_square)
            rungs.append(tried[effect])
            left.remove(effect)
        return rungs


def _steps(effects: int, most: int) -> int:
    """Steps at most from a set of so many effects to the end of a diagnosis.

    A step is a model that is fitted, a screening, or a choice.
    """
    grown = range(effects + 1, most + 1)
    return sum(2 + SINGLES + PAIRS + n * EACH for n in grown) + _last(most)


def _last(effects: int) -> int:
    """Steps at most to prune the last set, for its rivals, and to look at what is left."""
    return effects * EACH + CEILINGS
