"""The search for the set of missing effects: joint additions, backward steps, exchanges.

Every set is fitted in full (`models`) and has to pass the questions of `criteria`; the held-out
trials can only veto.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Generic, TypeVar

from spirob.diagnosis.criteria import Criteria, Worth
from spirob.diagnosis.model import (
    ABSORBED,
    Found,
    Model,
    Offer,
    Predictor,
    equivalents,
    label,
    richness,
)
from spirob.diagnosis.rivals import alike, rivals
from spirob.effects import Effect
from spirob.progress import Steps

PAIRS, EXCHANGES = 3, 3  # finalists of a round, fitted in full
EACH = 2 + EXCHANGES + PAIRS  # steps for an effect of a set: without it, what is missing, others
CEILINGS = 2  # over the bare and the chosen model
IMITATED = 0.5  # of what an effect explains: with more structure left, it stands for another
POOR = 0.25  # of a model's squared error, if a fit from elsewhere leaves less: another valley
M = TypeVar("M", bound=Predictor)


class Search(Generic[M]):
    """Grows, prunes and exchanges sets of effects of one machine, its `models`."""

    def __init__(
        self,
        models: M,
        candidates: Sequence[type[Effect]],
        criteria: Criteria,
        progress: Callable[[str], None] = lambda text: None,
    ):
        self.models, self.criteria = models, criteria
        self.candidates = list(candidates)
        self.progress = models.progress = Steps(progress, _steps(0, criteria))
        self.vetoed: set[str] = set()

    @property
    def worth(self) -> Worth:
        """The questions of the criteria, for the least effect of the machine as it stands."""
        return Worth(self.criteria, self.models.least)

    def run(self) -> Found:
        """Search from the bare model."""
        current, first = self._begun()
        offers = first
        seen, afresh = {current.names}, False
        while len(current.effects) < self.criteria.most and not self.models.complete(current):
            grown = self._grown(current, offers)
            again = self.models.tried[current.names]
            if not afresh and self._elsewhere(current, again, grown):
                afresh, current = True, again
                self.models.tried = {again.names: again}  # others began beside the poor fit
                first = offers = self.offers(current, self.absent(current))
                continue
            current = again
            if grown is None:
                break
            kept = self._confirmed(current, grown, offers)
            if not _further(current, kept):
                break
            current = self._exchanged(kept)
            if current.names in seen:  # an exchange for a simpler effect may lead back
                break
            seen.add(current.names)
            self.progress(f"chosen so far: {label(current.effects)}")
            self.progress.expect(_steps(len(current.effects), self.criteria))
            if len(current.effects) < self.criteria.most and not self.models.complete(current):
                offers = self.offers(current, self.absent(current))
        self.progress.expect(_last(len(current.effects)))
        return self._found(self._ended(current), first)

    def settled(self, model: Model) -> Found:
        """What a search ends with that has come to this model: what of it matters, its rivals."""
        bare, offers = self._begun()
        self._grown(bare, offers)  # how far each alone comes is told of every search
        return self._found(self._pruned(model, whole=True), offers)

    def _begun(self) -> tuple[Model, list[Offer]]:
        """The bare model, and what may be missing of it: never what its numbers say themselves."""
        bare = self.models.fitted((), {})
        offers = self.offers(bare, self.candidates)
        possible = {o.effect for o in offers}
        self.candidates = [e for e in self.candidates if e in possible]
        return bare, offers

    def _confirmed(self, current: Model, grown: Model, offers: Sequence[Offer]) -> Model:
        """What the held-out trials leave of a grown model, or else of the next one, or pair."""
        tried: Model | None = grown
        while tried is not None:
            known = len(self.vetoed)
            kept = self._pruned(tried)
            if not _further(current, kept) and len(tried.effects) == len(current.effects) + 1:
                # what the held-out trials deny alone, they may confirm beside another
                kept = self._pruned(self._paired(current, offers) or current)
            if _further(current, kept) or len(self.vetoed) == known:
                return kept
            offers = [o for o in offers if o.effect.name() not in self.vetoed]
            tried = self._grown(current, offers)
        return current

    def _ended(self, model: Model) -> Model:
        """What matters at the end, with what comes next in the place of what is denied there."""
        for _ in range(self.criteria.most + 1):
            known = len(self.vetoed)
            kept = self._pruned(model, whole=True)
            if len(self.vetoed) == known:
                break
            grown = self._grown(kept, self.offers(kept, self.absent(kept)))
            if grown is None:
                break
            model = grown
        return kept

    def _elsewhere(self, model: Model, again: Model, grown: Model | None) -> bool:
        """Whether candidates were ranked beside a poor fit of a model, and rank otherwise now."""
        poor = again.mean_square < POOR * model.mean_square
        return not model.effects and again is not model and (poor or grown is None)

    def extended(
        self,
        effects: tuple[type[Effect], ...],
        start: Mapping[str, float],
        others: Sequence[type[Effect]],
    ) -> list[Model]:
        """Models of a set with each of the others that could matter beside it."""
        current = self.models.fitted(effects, start)
        offers = [o for o in self.offers(current, others) if self._possible(current, o.error)]
        return [
            self.models.fitted((*effects, o.effect), current.fit.changes | dict(o.values))
            for o in offers
        ]

    def without_imitations(self, found: Found, share: float) -> Found | None:
        """The same without its least effect, where half as much structure is left as that explains.

        A law that is not quite the machine's leaves structure behind, and a second law takes some
        of it: as long as more is left than it took, it stands for something else.  The first effect
        stays; what is left beside it, the verdict has to weigh.

        share  of the squared residual of the chosen model that is no noise
        """
        chosen = found.chosen
        if len(chosen.effects) < 2:
            return None
        lesser = {e: self.without(chosen, e) for e in chosen.effects}
        best = self.worth.best(list(lesser.values()))
        least = next(e for e, model in lesser.items() if model is best)
        fall = best.mean_square - chosen.mean_square
        if share * chosen.mean_square < max(IMITATED * fall, self.worth.least**2):
            return None
        return self.less(found, least)

    def less(self, found: Found, effect: type[Effect]) -> Found:
        """The same without one of the chosen effects, and without what counts only beside it."""
        lesser = self.without(found.chosen, effect)
        return self._found(self._pruned(lesser, whole=True), found.offers)

    def narrowed(self, found: Found, names: Sequence[str]) -> Found:
        """The same with some of the chosen effects alone; their rivals stay what they were."""
        chosen = found.chosen
        effects = tuple(e for e in chosen.effects if e.name() in names)
        model = self.models.finished(self.models.fitted(effects, chosen.fit.changes))
        rivals, same = (
            {name: of[name] for name in names} for of in (found.rivals, found.equivalents)
        )
        return Found(self.rungs(model), found.offers, rivals, same, found.vetoed)

    def exchanged(self, found: Found) -> Found | None:
        """With what does better now that something beside it is gone; None where nothing does."""
        model, offers = self._exchanged(found.chosen), found.offers
        same = model is found.chosen
        return None if same else self._found(self._pruned(model, whole=True), offers)

    def _found(self, chosen: Model, offers: list[Offer]) -> Found:
        chosen = self.models.finished(chosen)
        found = Found(self.rungs(chosen), offers, vetoed=sorted(self.vetoed - chosen.names))
        for effect in chosen.effects:
            same, other = equivalents(chosen, rivals(self, chosen, effect), self.worth.least)
            same = sorted({*same, *alike(self, chosen, effect)})
            found.equivalents[effect.name()] = same
            found.rivals[effect.name()] = [name for name in other if name not in same]
        return found

    def absent(self, model: Model) -> list[type[Effect]]:
        """Candidates that may be added to a model."""
        out = model.names | self.vetoed
        return [
            e
            for e in self.candidates
            if e.name() not in out and not self.models.related(e, model.effects)
        ]

    def offers(self, model: Model, effects: Sequence[type[Effect]]) -> list[Offer]:
        return [o for o in self.models.offers(model, effects) if o.new > ABSORBED]

    def _grown(self, current: Model, offers: Sequence[Offer]) -> Model | None:
        """The best addition of one effect or of two, None where none matters."""
        most = self.criteria.finalists
        singles = [(o,) for o in offers[:most] if self._possible(current, o.error)]
        best = self._best_of(current, singles)
        again = self.models.tried[current.names]
        if best is not None or again is not current:
            return best
        return self._paired(current, offers)

    def _paired(self, current: Model, offers: Sequence[Offer]) -> Model | None:
        """The best addition of two: each alone may raise the error that they lower together."""
        if self.criteria.most - len(current.effects) < 2:
            return None
        pairs = self.models.pairs(current, offers)
        pairs = [p for p in pairs if not self.models.related(p[1].effect, [p[2].effect])]
        tried = [(a, b) for error, a, b in pairs[:PAIRS] if self._possible(current, error)]
        return self._best_of(current, tried)

    def _possible(self, current: Model, error: float) -> bool:
        return self.worth.possible(current, error, self.models.promised)

    def _best_of(self, current: Model, sets: Sequence[tuple[Offer, ...]]) -> Model | None:
        """Fit each extension in full and take the simplest of the good ones."""
        grown = self._extended(current, sets)
        current = self.models.tried[current.names]
        passed = [m for m in grown if self.worth.matters(current, m) and self.models.plain(m)]
        return self.worth.simplest(self.worth.standing(passed)) if passed else None

    def _extended(
        self, current: Model, sets: Sequence[tuple[Offer, ...]], near: Model | None = None
    ) -> list[Model]:
        # the least effect may be smaller beside what is added, so it is asked for each time
        return self.models.grown(current, sets, lambda a, b: self.worth.matters(a, b), near)

    def without(self, model: Model, effect: type[Effect]) -> Model:
        """The model without one of its effects."""
        rest = tuple(e for e in model.effects if e is not effect)
        return self.models.fitted(rest, model.fit.changes)

    def _pruned(self, model: Model, whole: bool = False) -> Model:
        """Backward elimination: every effect has to matter beside the others, and all be plain.

        whole  nothing more will be added: until then what is still missing may hide an effect on
               the held-out trials, which deny it only where they contradict it
        """
        while model.effects:
            lesser = {e: self.without(model, e) for e in model.effects}
            weak = [e for e in model.effects if not self.worth.matters(lesser[e], model)]
            denied = [e for e in model.effects if self.worth.denied(lesser[e], model, whole)]
            self.vetoed |= {e.name() for e in denied if e not in weak}
            if not weak and not denied:
                if self.models.plain(model):
                    return model
                weak = list(model.effects)
            model = self.worth.best([lesser[e] for e in (*weak, *denied)])
        return model

    def _exchanged(self, model: Model) -> Model:
        """Exchange effects for better or simpler ones that the held-out trials do not refute."""
        for _ in range(self.criteria.most):
            if self.models.complete(model):
                return model
            others = [m for e in model.effects for m in self.exchanges(model, e)]
            others += [m for e in model.effects for m in self._divided(model, e)]
            others = [m for m in others if not self.worth.refuted(m, model)]
            chosen = self.worth.simplest([model, *others])
            if chosen is model:
                return model
            model = chosen
        return model

    def exchanges(self, model: Model, effect: type[Effect]) -> list[Model]:
        """Models with another effect in the place of this one."""
        lesser = self.without(model, effect)
        offers = self.offers(lesser, self.absent(lesser))
        others = [(o,) for o in offers if o.effect is not effect][:EXCHANGES]
        return [m for m in self._extended(lesser, others, model) if self.models.plain(m)]

    def _divided(self, model: Model, effect: type[Effect]) -> list[Model]:
        """Models with a plainer law of its kind and another effect in the place of this one.

        A law of many numbers bends to what two plain ones do together: a wide peak of dry friction
        to dry friction and a drag.  The two have no more numbers than it.
        """
        lesser, room = self.without(model, effect), richness(effect)
        offers = [o for o in self.offers(lesser, self.absent(lesser)) if o.effect is not effect]
        kin = {o.effect for o in offers if self.models.related(o.effect, [effect])}
        if not kin or len(model.effects) == self.criteria.most:
            return []
        pairs = [
            (a, b)
            for _, a, b in self.models.pairs(lesser, offers)
            if len(kin & {a.effect, b.effect}) == 1
            and richness(a.effect) + richness(b.effect) <= room
        ]
        return [m for m in self._extended(lesser, pairs[:PAIRS], model) if self.models.plain(m)]

    def rungs(self, model: Model) -> list[Model]:
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


def _further(before: Model, after: Model) -> bool:
    return after.names != before.names and after.mean_square < before.mean_square


def _steps(effects: int, criteria: Criteria) -> int:
    """Steps at most from a set of so many effects to the end of a diagnosis.

    A step is a model that is fitted, a screening, or a choice.
    """
    grown = range(effects + 1, criteria.most + 1)
    return sum(2 + criteria.finalists + PAIRS + n * EACH for n in grown) + _last(criteria.most)


def _last(effects: int) -> int:
    """Steps at most to prune the last set, for its rivals, and to look at what is left."""
    return effects * EACH + CEILINGS
