"""When is an effect worth its place?  The three questions that every addition has to pass.

Does the error of the folds left out rise without it by more than a floor, in size and in share?
Surely, when half-second blocks are drawn again, by their mean or by their typical fall?  And do
the held-out trials agree?
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Protocol

import numpy as np
from pydantic import ConfigDict, Field

from spirob.diagnosis.evidence import improvement
from spirob.diagnosis.model import Model
from spirob.identify.builds import RESOLUTION

HALF = 0.5
DRAWS, UNSURE = 2000, 0.025  # of blocks, and the share of draws that may deny what is sure
TINY = 1e-300


@dataclass(frozen=True)
class Criteria:
    """How the search decides: the key `criteria` of a description, or `settings` from Python.

    From which probability a name is given is `LIKELY` in `certainty`.

    floor      least size of an effect: √(fall of the mean square) over the RMS effort; more where
               the noise of the motion makes more of the modelled effort, or where builds of a
               machine that are drawn about it differ by more
    share      least fall of the squared error, relative
    veto       least fall of the squared error on held-out trials, relative
    better     relative fall that makes a richer effect worth its further numbers
    richer     least size, over the floor, of what a richer law explains beyond a simpler one
    most       effects in a set
    finalists  candidates of a round that are fitted in full
    """

    floor: Annotated[float, Field(gt=0, lt=1)] = 0.01
    share: Annotated[float, Field(ge=0, lt=1)] = 0.05
    veto: Annotated[float, Field(ge=0, lt=1)] = 0.05
    better: Annotated[float, Field(ge=0, lt=1)] = 0.10
    richer: Annotated[float, Field(ge=0, le=10)] = 1.0
    most: Annotated[int, Field(ge=0, le=10)] = 4
    finalists: Annotated[int, Field(ge=1, le=100)] = 4
    seed: Annotated[int, Field(ge=0)] = 0
    __pydantic_config__ = ConfigDict(extra="forbid", allow_inf_nan=False)


@dataclass(frozen=True)
class ArmCriteria(Criteria):
    """How the search on a simulated arm decides: `diagnose` of a configuration.

    floor       the least that is taken where builds of the arm differ by less
    iterations  sets of differences in the fit of a finalist
    patience    sets of differences in a last fit, and in the fit of the numbers alone

    Every model is a simulation: fewer effects are looked for, and more are tried in each round, as
    its screening sees less.
    """

    floor: Annotated[float, Field(gt=0, lt=1)] = RESOLUTION
    richer: Annotated[float, Field(ge=0, le=10)] = 0.0
    most: Annotated[int, Field(ge=0, le=10)] = 2
    finalists: Annotated[int, Field(ge=1, le=100)] = 6
    iterations: Annotated[int, Field(ge=1, le=1000)] = 2
    patience: Annotated[int, Field(ge=1, le=1000)] = 6
    __pydantic_config__ = ConfigDict(extra="forbid", allow_inf_nan=False)


@dataclass(frozen=True)
class Settings(ArmCriteria):
    """The criteria, and what a caller chooses.

    scale      of the robust loss, in the unit of the effort
    intervals  exact ones for the numbers of what was chosen; a trial of many robots does without
    always     look for effects, for a report to show, even where the fitted numbers alone leave
               less than counts; a trial of many robots does without
    """

    scale: float = 0.05
    intervals: bool = True
    always: bool = True


class Judged(Protocol):
    """What is asked of a model, or of a draft of a law: `errors` by block, mean squares."""

    @property
    def errors(self) -> np.ndarray: ...
    @property
    def mean_square(self) -> float: ...
    @property
    def heldout_square(self) -> float: ...


@dataclass(frozen=True)
class Worth:
    """The questions; `least` is the size of the least effect, in the unit of the effort."""

    settings: Criteria
    least: float

    def matters(self, before: Judged, after: Judged) -> bool:
        """Whether `after` explains more by a size that counts, surely."""
        return self._falls(before, after, self.least)

    def _falls(self, before: Judged, after: Judged, least: float) -> bool:
        fall = before.mean_square - after.mean_square
        if fall <= 0.0 or np.sqrt(fall) < least:
            return False
        if fall < self.settings.share * before.mean_square:
            return False
        return self._surely(before, after)

    def clearly(self, before: Judged, after: Judged) -> bool:
        """Whether `after` is better than a rival by enough to be preferred to a simpler one."""
        if after.mean_square > (1.0 - self.settings.better) * before.mean_square:
            return False
        return self._surely(before, after)

    def halves(self, before: Judged, after: Judged) -> bool:
        """Whether `after` leaves less than half the squared error, held out too, and surely."""
        if after.mean_square > HALF * before.mean_square:
            return False
        if after.heldout_square > HALF * before.heldout_square:
            return False
        return self._surely(before, after)

    def _surely(self, before: Judged, after: Judged) -> bool:
        """Whether the fall holds when blocks are drawn again, of errors or of their logarithms.

        The logarithms weigh every block alike: one block with a blow in it decides nothing.
        """
        seed = self.settings.seed
        if improvement(before.errors, after.errors, seed)[1] > 0.0:
            return True
        falls = np.log(before.errors + TINY) - np.log(after.errors + TINY)
        draws = np.random.default_rng(seed).integers(0, len(falls), (DRAWS, len(falls)))
        return bool(np.quantile(falls[draws].mean(axis=1), UNSURE) > 0.0)

    def possible(self, current: Model, error: float, promised: float) -> bool:
        """Whether an addition could matter, judged by its screened error.

        promised  share of the least effect that it has to promise
        """
        return current.mean_square - error > (promised * self.least) ** 2

    def denied(self, before: Judged, after: Judged, whole: bool = True) -> bool:
        """Whether the held-out trials contradict a step, or do not confirm one of a `whole` set."""
        least = 1.0 - (self.settings.veto if whole else 0.0)
        return after.heldout_square > least * before.heldout_square

    def refuted(self, model: Judged, other: Judged) -> bool:
        """Whether another leaves half of what the model leaves held out, less by what counts."""
        fall = model.heldout_square - other.heldout_square
        return fall > max((1.0 - HALF) * model.heldout_square, self.least**2)

    def simplest(self, models: Sequence[Model]) -> Model:
        """The poorest model to which no other is clearly preferable.

        A richer model has to be better by the least size of an effect: the edges of a smooth sign
        never fit quite, and a richer law always takes some of that.  An equal that the held-out
        trials refute beside another is none: on logs of one direction dry friction is a constant
        force, and one of the other direction tells.
        """
        best = min(models, key=lambda m: m.mean_square)
        equal = [m for m in models if m is best or not self._beaten(m, best)]
        equal = [m for m in equal if not any(self.refuted(m, other) for other in equal)]
        return min(equal, key=lambda m: (len(m.effects), m.numbers, m.mean_square))

    def _beaten(self, model: Model, best: Model) -> bool:
        if model.numbers < best.numbers:
            return self._falls(model, best, self.settings.richer * self.least)
        return self.clearly(model, best)
