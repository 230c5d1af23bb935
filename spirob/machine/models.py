"""Sets of effects, each fitted in full on the training trials and judged on data left out."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spirob.diagnosis.evidence import block_errors
from spirob.diagnosis.flexible import folds_of
from spirob.effects import Effect
from spirob.identify.fit import Fit, fit
from spirob.machine.flexible import left_out_linear
from spirob.machine.inverse import InverseProblem
from spirob.machine.laws import shares_inertia
from spirob.machine.screening import room
from spirob.score import Score, score

ITERATIONS = 40  # of a fit at most: one that has not arrived is taken for a poorer law
# of differences, in scaled numbers: an inverse model is smooth, and the order of a ripple over many
# turns needs a fine one
STEP = 1e-3
DELAY = "rig.delay"
ROBUST = 10.0  # times the effort, where errors begin to count linearly: repairs took the outliers
ROUGH = 0.02  # where blows come earlier or later by a number, and the residual is not smooth


@dataclass(frozen=True)
class Model:
    """A set of effects, fitted; errors are mean squares by block.

    left     residual of each training sample after a step that the other folds chose
    heldout  residual on the held-out trials
    """

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
        """How rich it is: numbers of its effects, and one more for each that has a memory.

        How many cells a memory takes is a matter of its program: a delay needs many, and one time.
        """
        return sum(len(e.parameters()) + bool(e.state) for e in self.effects)


class Models:
    """Fits sets of effects and keeps every one.

    base   names of the numbers that every set fits
    size   RMS of the measured effort
    tried  names of the effects -> model
    """

    def __init__(
        self,
        train: InverseProblem,
        heldout: InverseProblem,
        base: Sequence[str],
        progress: Callable[[str], None] = lambda text: None,
    ):
        self.train, self.heldout, self.base, self.progress = train, heldout, list(base), progress
        self.folds = folds_of(_halves(train.edges))
        self.size = float(np.sqrt(np.mean(train.measured() ** 2)))
        self.tried: dict[frozenset[str], Model] = {}

    def fitted(self, effects: tuple[type[Effect], ...], start: Mapping[str, float]) -> Model:
        """The fitted model of a set; `start` holds where its numbers begin."""
        key = frozenset(e.name() for e in effects)
        if key not in self.tried:
            self.tried[key] = self.without((), effects, start)
        return self.tried[key]

    def without(
        self,
        silent: Collection[str],
        effects: tuple[type[Effect], ...],
        start: Mapping[str, float],
    ) -> Model:
        """The same with some numbers of the effects left at neutral; it is not kept."""
        own = (f"{e.name()}.{f}" for e in effects for f in e.fitted())
        names = [*self.base, *(n for n in own if n not in silent)]
        table = self.train.table
        begin = {n: start.get(n, table.about[n].nominal) for n in names}
        robust = ROBUST * self.size  # plain least squares inside
        rough = any(shares_inertia(e) for e in effects)
        # a bounce is one moment: where the delay may be far off, it lies in a valley of its own
        starts = [begin, begin | {DELAY: 0.0}] if rough and begin.get(DELAY) else [begin]
        fits = [
            fit(
                self.train,
                names,
                start,
                robust,
                ITERATIONS,
                steps=(ROUGH if rough else STEP,),
                exact=False,
                smooth=True,
            )
            for start in starts
        ]
        found = min(fits, key=lambda made: made.cost)
        left = left_out_linear(found.jacobian, found.residual, self.folds, *room(table, found))
        held = self.heldout(found.changes)
        made = Model(
            effects,
            found,
            left,
            block_errors(left, self.train.edges, self.train.block),
            held,
            block_errors(held, self.heldout.edges, self.heldout.block),
        )
        share = np.sqrt(made.mean_square) / self.size
        self.progress(f"{label(effects)}: {share:.2%} of the effort left")
        return made

    def scores(self, model: Model) -> dict[str, Score]:
        """Scores of a model on the trials that it was fitted to and on the held-out ones."""
        measured = self.train.measured(), self.heldout.measured()
        return {
            "train": score(measured[0], measured[0] + model.fit.residual),
            "test": score(measured[1], measured[1] + model.heldout),
        }


def _halves(edges: np.ndarray) -> np.ndarray:
    """Edges of the halves of trials: a fold left out must not take all that one condition tells.

    The one trial that turns back, or carries the load, decides between two laws; without any of it
    the others would say nothing about them.
    """
    return np.unique(np.concatenate([edges, (edges[:-1] + edges[1:]) // 2]))


def label(effects: Sequence[type[Effect]]) -> str:
    """A set of effects in a line of progress."""
    return " + ".join(e.name() for e in effects) or "the fitted numbers alone"
