"""The search for the set of missing effects: joint additions, backward steps, exchanges.

Every set is fitted in full on the training trials, all numbers together, and judged on folds that
are left out (whole trials, or blocks where there are fewer than three); the held-out trials can
only veto.  Three things are asked of each effect of a set: that without it the error of the folds
left out rises by more than a floor, in size and in share; that it does so surely when half-second
blocks are drawn again; and that the held-out trials agree.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from spirob.diagnose.evidence import block_errors, improvement
from spirob.effects import Effect
from spirob.identify.fit import Fit, fit
from spirob.machine.inverse import InverseProblem
from spirob.machine.screening import ABSORBED, Offer, Screening, left_out
from spirob.score import Score, score

SINGLES, PAIRS, EXCHANGES = 4, 3, 3  # finalists of a round, fitted in full
BLOCKS = 5  # folds of one or two trials


@dataclass(frozen=True)
class Settings:
    """How the search decides.

    floor    least size of an effect: √(fall of the mean square) over the RMS effort
    share    least fall of the squared error, relative
    veto     least fall of the squared error on held-out trials, relative
    better   relative fall that makes a richer effect worth its further numbers
    most     effects in a set
    step     of differences, in scaled numbers: an inverse model is smooth, and the order of a
             ripple over many turns needs a fine one
    """

    floor: float = 0.01
    share: float = 0.05
    veto: float = 0.05
    better: float = 0.10
    most: int = 4
    iterations: int = 12
    step: float = 1e-3
    seed: int = 0


@dataclass(frozen=True)
class Model:
    """A set of effects, fitted; errors are mean squares by block."""

    effects: tuple[type[Effect], ...]
    fit: Fit
    left: np.ndarray
    errors: np.ndarray
    heldout: np.ndarray
    heldout_errors: np.ndarray

    @property
    def mean_square(self) -> float:
        """Of the folds left out."""
        return float(np.mean(self.left**2))

    @property
    def heldout_square(self) -> float:
        """Of the held-out trials."""
        return float(np.mean(self.heldout**2))

    @property
    def names(self) -> frozenset[str]:
        """Names of its effects."""
        return frozenset(e.name() for e in self.effects)

    @property
    def numbers(self) -> int:
        """How rich it is: numbers and memories of its effects."""
        return sum(len(e.parameters()) + len(e.state) for e in self.effects)


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
    tried: dict[frozenset[str], Model]
    rivals: dict[str, list[Model]] = field(default_factory=dict)
    vetoed: list[str] = field(default_factory=list)

    @property
    def chosen(self) -> Model:
        """The model that the search stands by."""
        return self.rungs[-1]


class Search:
    """Holds the problems and every model fitted so far."""

    def __init__(
        self,
        train: InverseProblem,
        heldout: InverseProblem,
        names: Sequence[str],
        candidates: Sequence[type[Effect]],
        settings: Settings,
        progress: Callable[[str], None] = lambda text: None,
    ):
        self.train, self.heldout, self.base = train, heldout, list(names)
        self.candidates, self.settings, self.progress = list(candidates), settings, progress
        self.folds = folds_of(train.edges)
        self.size = float(np.sqrt(np.mean(train.measured() ** 2)))
        self.tried: dict[frozenset[str], Model] = {}
        self.vetoed: set[str] = set()

    def run(self) -> Found:
        """Search from the bare model."""
        bare = self.model((), {})
        current, offers = bare, self._screen(bare, self.candidates)
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
            self.progress(f"chosen so far: {', '.join(sorted(current.names))}")
            offers = self._screen(current, self._absent(current))
        current = self._pruned(current)
        found = Found(self._rungs(current), first, self.tried)
        found.rivals = {e.name(): self._rivals(current, e) for e in current.effects}
        found.vetoed = sorted(self.vetoed - current.names)
        return found

    def model(self, effects: tuple[type[Effect], ...], start: Mapping[str, float]) -> Model:
        """The fitted model of a set; `start` holds where its numbers begin."""
        key = frozenset(e.name() for e in effects)
        if key in self.tried:
            return self.tried[key]
        names = [*self.base, *(f"{e.name()}.{f}" for e in effects for f in e.parameters())]
        table = self.train.table
        begin = {n: start.get(n, table.about[n].nominal) for n in names}
        robust = 10.0 * self.size  # repairs have taken the outliers; plain least squares inside
        most, steps = self.settings.iterations, (self.settings.step,)
        found = fit(self.train, names, begin, robust, most, steps=steps, exact=False, smooth=True)
        left = left_out(found.jacobian, found.residual, self.folds)
        held = self.heldout(found.changes)
        made = Model(
            effects,
            found,
            left,
            block_errors(left, self.train.edges, self.train.block),
            held,
            block_errors(held, self.heldout.edges, self.heldout.block),
        )
        self.tried[key] = made
        share = np.sqrt(made.mean_square) / self.size
        self.progress(f"{' + '.join(e.name() for e in effects) or 'bare model'}: {share:.2%}")
        return made

    def matters(self, before: Model, after: Model) -> bool:
        """Whether `after` explains more by a size that counts, surely."""
        fall = before.mean_square - after.mean_square
        if fall <= 0.0 or np.sqrt(fall) < self.settings.floor * self.size:
            return False
        if fall < self.settings.share * before.mean_square:
            return False
        return improvement(before.errors, after.errors, self.settings.seed)[1] > 0.0

    def clearly(self, before: Model, after: Model) -> bool:
        """Whether `after` is better than a rival by enough to be preferred to a simpler one."""
        if after.mean_square > (1.0 - self.settings.better) * before.mean_square:
            return False
        return improvement(before.errors, after.errors, self.settings.seed)[1] > 0.0

    def _worth(self, current: Model, error: float) -> bool:
        """Whether an addition could matter, judged by its screened error and half the floor."""
        return current.mean_square - error > (0.5 * self.settings.floor * self.size) ** 2

    def _absent(self, model: Model) -> list[type[Effect]]:
        return [e for e in self.candidates if e.name() not in model.names | self.vetoed]

    def _screen(self, model: Model, effects: Sequence[type[Effect]]) -> list[Offer]:
        at = model.fit
        screening = Screening(self.train, at.residual, at.jacobian, at.changes, self.folds)
        self._last = screening
        return [o for o in screening.offers(effects) if o.new > ABSORBED]

    def _grown(self, current: Model, offers: Sequence[Offer]) -> Model | None:
        """The best addition of one effect or of two, None where none matters."""
        room = self.settings.most - len(current.effects)
        singles = [(o,) for o in offers[:SINGLES] if self._worth(current, o.error)]
        best = self._best_of(current, singles)
        if best is not None or room < 2:
            return best
        # two true effects may each raise the error alone and lower it together
        pairs = self._last.pairs(offers)[:PAIRS]
        return self._best_of(
            current, [(a, b) for error, a, b in pairs if self._worth(current, error)]
        )

    def _best_of(self, current: Model, sets: Sequence[tuple[Offer, ...]]) -> Model | None:
        """Fit each extension in full and take the simplest of the good ones."""
        grown = []
        for chosen in sets:
            start = dict(current.fit.changes)
            for offer in chosen:
                start |= offer.values
            added = (*current.effects, *(offer.effect for offer in chosen))
            grown.append(self.model(added, start))
        passed = [m for m in grown if self.matters(current, m)]
        return self._simplest(passed) if passed else None

    def _simplest(self, models: Sequence[Model]) -> Model:
        """The poorest model to which no other is clearly preferable.

        A richer model has to be better by the least size of an effect: the edges of a smooth sign
        never fit quite, and a richer law always takes some of that.
        """
        best = min(models, key=lambda m: m.mean_square)
        equal = [m for m in models if m is best or not self._beaten(m, best)]
        return min(equal, key=lambda m: (len(m.effects), m.numbers, m.mean_square))

    def _beaten(self, model: Model, best: Model) -> bool:
        if model.numbers < best.numbers:
            return self.matters(model, best)
        return self.clearly(model, best)

    def _without(self, model: Model, effect: type[Effect]) -> Model:
        rest = tuple(e for e in model.effects if e is not effect)
        return self.model(rest, model.fit.changes)

    def _pruned(self, model: Model) -> Model:
        """Backward elimination: every effect has to matter in the presence of the others."""
        while model.effects:
            lesser = {e: self._without(model, e) for e in model.effects}
            weak = [e for e in model.effects if not self.matters(lesser[e], model)]
            denied = [e for e in model.effects if self._denied(lesser[e], model)]
            self.vetoed |= {e.name() for e in denied if e not in weak}
            if not weak and not denied:
                return model
            model = min((lesser[e] for e in weak or denied), key=lambda m: m.mean_square)
        return model

    def _denied(self, before: Model, after: Model) -> bool:
        """Whether the held-out trials do not confirm a step."""
        least = 1.0 - self.settings.veto
        return after.heldout_square > least * before.heldout_square

    def _exchanged(self, model: Model) -> Model:
        """Exchange effects for better or simpler ones until none is left."""
        for _ in range(self.settings.most):
            others = [m for e in model.effects for m in self._exchanges(model, e)]
            chosen = self._simplest([model, *others])
            if chosen is model:
                return model
            model = chosen
        return model

    def _exchanges(self, model: Model, effect: type[Effect]) -> list[Model]:
        """Models with another effect in the place of this one."""
        lesser = self._without(model, effect)
        offers = [o for o in self._screen(lesser, self._absent(lesser)) if o.effect is not effect][
            :EXCHANGES
        ]
        made = []
        for offer in offers:
            start = {**lesser.fit.changes, **offer.values}
            effects = tuple(offer.effect if e is effect else e for e in model.effects)
            if len({e.name() for e in effects}) == len(effects):
                made.append(self.model(effects, start))
        return made

    def _rivals(self, model: Model, effect: type[Effect]) -> list[Model]:
        """Exchanges that are neither richer nor clearly worse."""
        others = self._exchanges(model, effect)
        return [m for m in others if m.numbers <= model.numbers and not self.clearly(m, model)]

    def _rungs(self, model: Model) -> list[Model]:
        """From the bare model upward, each time the effect that takes most off the error."""
        rungs, left = [self.model((), {})], list(model.effects)
        while left:
            tried = {
                e: self.model((*rungs[-1].effects, e), model.fit.changes)
                if len(left) > 1
                else model
                for e in left
            }
            effect = min(tried, key=lambda e: tried[e].mean_square)
            rungs.append(tried[effect])
            left.remove(effect)
        return rungs


def folds_of(edges: np.ndarray) -> np.ndarray:
    """Label of the fold of each sample: its trial, or a block of the whole where trials are few."""
    trials = len(edges) - 1
    if trials >= 3:
        return np.repeat(np.arange(trials), np.diff(edges))
    samples = int(edges[-1])
    return np.arange(samples) * BLOCKS // samples


def scores(search: Search, model: Model) -> dict[str, Score]:
    """Scores of a model on the trials that it was fitted to and on the held-out ones."""
    measured = search.train.measured(), search.heldout.measured()
    return {
        "train": score(measured[0], measured[0] + model.fit.residual),
        "test": score(measured[1], measured[1] + model.heldout),
    }
