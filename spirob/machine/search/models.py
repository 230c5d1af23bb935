"""Sets of effects on a rig, each fitted in full on the training trials, judged on data left out.

What a fitted model leaves of a fold that its fit has not seen is that by the others' numbers, which
are a step of Gauss and Newton away from those of all.  Where the model is bent on the way (a limit
of the torque that one fold alone reaches, a band within which nothing moves), that step goes
astray, and the others are fitted anew.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cached_property

import numpy as np

from spirob.diagnosis.criteria import Criteria, block_errors
from spirob.diagnosis.flexible import folds_of
from spirob.diagnosis.model import ABSORBED, Counts, Left, Model, Offer, Predictor, Sets, label
from spirob.diagnosis.regression import products, steps
from spirob.diagnosis.search import Search
from spirob.effects import Effect
from spirob.identify.descent import descend, slopes_ahead
from spirob.identify.fit import Fit, fit
from spirob.identify.intervals import Score, score
from spirob.identify.scaling import Scaling
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.shapes import repeated_waves, same_wave, seldom_seen, turned_round
from spirob.machine.laws import related, shares_inertia
from spirob.machine.recordings.filtering import noise_in_effort
from spirob.machine.search.delays import DELAY, only_aligns
from spirob.machine.search.leftovers import (
    RigCeiling,
    left_of,
    nothing,
    rig_ceiling,
    structured,
    unexplained,
)
from spirob.machine.search.screening import Screening, room

BENT = 0.1  # of the residual: by so much it may differ from what its slopes told of a step
WORST = 1e6  # of the largest residual: by how much more a fold is missed says nothing
LONG = 1.5e8  # samples played: half a minute of a core, and a diagnosis is to end in one
PAIR = 2  # effects that are looked for whatever it takes
ROUNDS = 2  # of a fit to the others: it begins with known slopes, close to where it ends
SETTLED = 1e-3  # relative fall of the squared residual in a step that ends it
LEAST = 1e-3  # of an effort that is passed on: a drive that takes it all explains nothing
PLAIN = 1e3  # times the residual, where errors would begin to count linearly: plain least squares


def left_out(problem: InverseProblem, found: Fit, folds: np.ndarray, width: float) -> np.ndarray:
    """The residual of each fold by the numbers that the other folds ask for, (N,).

    A fold on which the others' numbers run away is missed by `WORST`, never by what has no square.

    found  fitted to all of them;  folds  (N,) label of each sample
    width  of differences, in the coordinates of `Scaling`
    """
    scaling = Scaling(problem.table, list(found.estimates))
    moved = steps(products(found.jacobian, found.residual, folds), *room(problem.table, found))
    begin, out = scaling.scaled(found.changes), np.empty_like(found.residual)
    starts = np.flatnonzero(np.diff(folds, prepend=folds[0] - 1))
    for fold, step in zip(folds[starts], moved, strict=True):
        inside = folds == fold
        residual = problem(found.changes | scaling.physical(begin + step))
        told = found.residual + found.jacobian @ step
        with np.errstate(over="ignore"):
            off = np.linalg.norm(residual - told)
        if off > BENT * np.linalg.norm(found.residual):
            numbers = _fitted(problem, scaling, found, ~inside, width)
            residual = problem(found.changes | numbers)
        out[inside] = residual[inside]
    worst = WORST * float(np.max(np.abs(found.residual)))
    return np.clip(np.nan_to_num(out, nan=worst), -worst, worst)


def _fitted(
    problem: InverseProblem, scaling: Scaling, found: Fit, others: np.ndarray, width: float
) -> dict[str, float]:
    """The numbers fitted to some samples alone, from those that fit all."""

    def everywhere(u: np.ndarray) -> np.ndarray:
        return problem(found.changes | scaling.physical(u))

    def value(u: np.ndarray) -> np.ndarray:
        return everywhere(u)[others]

    def differences(u: np.ndarray, at: np.ndarray) -> np.ndarray:
        return slopes_ahead(problem, scaling, u, found.changes, everywhere(u), width)[others]

    begin, slopes = scaling.scaled(found.changes), found.jacobian[others]
    plain = PLAIN * float(np.std(found.residual))
    box = scaling.around
    ended = descend(value, differences, begin, box, plain, ROUNDS, SETTLED, slopes=slopes)
    return scaling.physical(ended.u)


ITERATIONS = 40  # of a fit at most: one that has not arrived is taken for a poorer law
# of differences, in scaled numbers: an inverse model is smooth, and the order of a ripple over many
# turns needs a fine one
STEP = 1e-3
ROBUST = 10.0  # times the effort, where errors begin to count linearly: repairs took the outliers
ROUGH = 0.02  # where blows come earlier or later by a number, and the residual is not smooth


class Models(Predictor):
    """Fits sets of effects and keeps every one: the `Predictor` of a rig.

    floor  least size of an effect, over the RMS effort
    """

    promised = 0.5

    def __init__(
        self,
        train: InverseProblem,
        heldout: InverseProblem,
        names: Sequence[str],
        floor: float = Criteria.floor,
    ):
        self.train: InverseProblem = train
        self.heldout: InverseProblem = heldout
        self.names = list(names)
        self.progress: Callable[[str], None] = lambda text: None
        self.folds = folds_of(_halves(train.edges))
        self.size = float(np.sqrt(np.mean(train.measured() ** 2)))
        self.robust = ROBUST * self.size  # plain least squares inside
        self.tried: dict[frozenset[str], Model] = {}
        self._screened: dict[frozenset[str], Screening] = {}
        self._ceilings: dict[frozenset[str], RigCeiling] = {}
        self._floor = floor

    @cached_property
    def least(self) -> float:
        """The least size of an effect: a share of the effort, or the noise of the motion in it."""
        return max(self._floor * self.size, self.noise[0])

    @cached_property
    def noise(self) -> tuple[float, float]:
        """What noise of the motion leaves of the effort, and by what share inertia is too low."""
        modelled = self.train.measured() + self.fitted((), {}).fit.residual
        squares = [p.noise**2 for r in self.train.recordings for p in r.pieces]
        noise = float(np.sqrt(np.mean(squares)))
        return noise_in_effort(noise, modelled, self.train.compared_motion())

    def grown(
        self, current: Model, sets: Sets, counts: Counts, near: Model | None = None
    ) -> list[Model]:
        """The model with each of these sets added; every fit ends where it settles."""
        found = []
        for added in sets:
            start = dict((near or current).fit.changes)
            for offer in added:
                start |= offer.values
            effects = (*current.effects, *(offer.effect for offer in added))
            found.append(self.fitted(effects, start))
        return found

    def offers(self, model: Model, effects: Sequence[type[Effect]]) -> list[Offer]:
        """The effects beside a model, by a regression on their columns."""
        screening = self._screening(model)
        if new := screening.untried(effects):
            self.progress(f"{len(new)} effects screened beside {label(model.effects)}")
        return screening.offers(effects)

    def pairs(self, model: Model, offers: Sequence[Offer]) -> list[tuple[float, Offer, Offer]]:
        """Pairs of these, on the same columns."""
        return self._screening(model).pairs(offers)

    def _screening(self, model: Model) -> Screening:
        if model.names not in self._screened:
            made = Screening(self.train, model.fit, self.folds)
            self._screened[model.names] = made
        return self._screened[model.names]

    def related(self, effect: type[Effect], others: Sequence[type[Effect]]) -> bool:
        """Whether one of the others is the same kind of law, of which a machine has only one."""
        return related(effect, others)

    def absorbs(self, model: Model, effect: type[Effect]) -> bool:
        """Whether an effect's columns are those of the model's numbers."""
        return all(offer.new <= ABSORBED for offer in self.offers(model, [effect]))

    def plain(self, model: Model) -> bool:
        """Whether no wave is there twice, seldom seen or a share beyond 1, and no delay is one."""
        sizes, period = self.train.sizes, max(r.period for r in self.train.recordings)
        waves = same_wave(model, sizes) or seldom_seen(model) or turned_round(model)
        return not waves and not only_aligns(model, self.train.rig, period)

    def complete(self, model: Model) -> bool:
        """Whether more than a pair is found, and the searches took their time (`LONG`).

        What builds of a rig differ by is not known: the error alone never ends a search.
        """
        return len(model.effects) > PAIR and self.is_long

    @property
    def is_long(self) -> bool:
        """Whether the searches took so much that another, begun otherwise, would take too long."""
        return self.train.work.samples > LONG

    @property
    def cut(self) -> bool:
        """Whether a search ended for its time alone."""
        most = max(len(model.effects) for model in self.tried.values())
        return self.is_long and most == PAIR + 1

    def finished(self, model: Model) -> Model:
        """The model itself: its fit has the intervals."""
        return model

    def left(self, model: Model) -> Left:
        """What is left of a model, by the ceiling over it."""
        return left_of(self, model, self.ceiling(model))

    def lacks(self, bare: Model) -> bool:
        """Whether what is left follows from the motion, or is far more than noise."""
        return structured(self, bare, self.ceiling(bare)) or unexplained(self, bare)

    def nothing(self, bare: Model) -> str:
        """Why nothing is missing, in a sentence."""
        return nothing(self, self.ceiling(bare))

    def ceiling(self, model: Model) -> RigCeiling:
        """What a flexible residual takes of what is left."""
        if model.names not in self._ceilings:
            self.progress(f"what follows from the motion beside {label(model.effects)}")
            about = model.fit.residual, model.heldout, self.folds
            self._ceilings[model.names] = rig_ceiling(self.train, self.heldout, *about)
        return self._ceilings[model.names]

    def fitted(self, effects: tuple[type[Effect], ...], start: Mapping[str, float]) -> Model:
        """The fitted model of a set; `start` holds where its numbers begin."""
        key = frozenset(e.name() for e in effects)
        if key not in self.tried:
            self.tried[key] = self._model(effects, self._each_wave_once(effects, start))
        return self.tried[key]

    def forget(self, denied: Callable[[type[Effect]], bool]) -> None:
        """No model with a denied effect stands beside the others any more."""
        self.tried = {n: m for n, m in self.tried.items() if not any(map(denied, m.effects))}

    def numbers(self, effects: tuple[type[Effect], ...], start: Mapping[str, float]) -> Fit:
        """The fit of a set alone, kept or made: what it leaves of folds left out takes as long."""
        known = self.tried.get(frozenset(e.name() for e in effects))
        return known.fit if known else self._each_wave_once(effects, start)

    def without(
        self,
        silent: Collection[str],
        effects: tuple[type[Effect], ...],
        start: Mapping[str, float],
    ) -> Model:
        """The same with some numbers of the effects left at neutral; it is not kept."""
        return self._model(effects, self._fit(silent, effects, start))

    def _each_wave_once(self, effects: tuple[type[Effect], ...], start: Mapping[str, float]) -> Fit:
        found = self._fit((), effects, start)
        if twice := repeated_waves(effects, found, self.train.sizes):
            once = {n: v for n, v in found.changes.items() if n not in twice}
            found = self._fit(twice, effects, once)
        return found

    def _fit(
        self,
        silent: Collection[str],
        effects: tuple[type[Effect], ...],
        start: Mapping[str, float],
    ) -> Fit:
        own = (f"{e.name()}.{f}" for e in effects for f in e.fitted())
        names = [*self.names, *(n for n in own if n not in silent)]
        table = self.train.table
        begin = {n: start.get(n, table.about[n].nominal) for n in names}
        rough = _is_rough(effects)
        # a bounce is one moment: where the delay may be far off, it lies in a valley of its own
        starts = [begin, begin | {DELAY: 0.0}] if rough and begin.get(DELAY) else [begin]
        fits = (
            fit(
                self.train,
                names,
                start,
                self.robust,
                ITERATIONS,
                steps=(ROUGH if rough else STEP,),
                exact=False,
                smooth=True,
            )
            for start in starts
        )
        return min(fits, key=lambda made: made.cost)

    def _model(self, effects: tuple[type[Effect], ...], found: Fit) -> Model:
        passing = self._passing(found)
        left = left_out(self.train, found, self.folds, ROUGH if _is_rough(effects) else STEP)
        left, held = left / passing, self.heldout(found.changes) / passing
        made = Model(
            effects,
            found,
            left,
            block_errors(left, self.train.edges, self.train.block),
            held,
        )
        share = np.sqrt(made.mean_square) / self.size
        self.progress(f"{label(effects)}: {share:.2%} of the effort left")
        return made

    def _passing(self, found: Fit) -> float:
        """Share of the effort that errors count over: what a model swallows of it is no merit."""
        return max(self.train.passing(found.changes), LEAST)

    def scores(self, model: Model) -> dict[str, Score]:
        """Scores of a model on the trials that it was fitted to and on the held-out ones."""
        measured = self.train.measured(), self.heldout.measured()
        fitted = model.fit.residual / self._passing(model.fit)
        return {
            "train": score(measured[0], measured[0] + fitted),
            "test": score(measured[1], measured[1] + model.heldout),
        }


def _is_rough(effects: Collection[type[Effect]]) -> bool:
    return any(shares_inertia(e) for e in effects)


def _halves(edges: np.ndarray) -> np.ndarray:
    """Edges of the halves of trials: a fold left out must not take all that one condition tells.

    The one trial that turns back, or carries the load, decides between two laws; without any of it
    the others would say nothing about them.
    """
    return np.unique(np.concatenate([edges, (edges[:-1] + edges[1:]) // 2]))


RigSearch = Search[Models]
