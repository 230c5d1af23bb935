"""When is an effect worth its place?  The evidence, and what every addition has to pass.

Evidence are errors on trials that no fit has seen, above a noise that no model can explain.
Residuals of a simulation are autocorrelated, so errors are resampled in blocks of half a second;
what a block bootstrap cannot tell apart is not told apart.  Whether an effect counts, only trials
that were not fitted say.  Which of several it is, the fitted ones help to say, where their errors
are raised by what the fit has taken of them: two laws that a short validation hardly tells apart
may differ plainly in four trials more.

Of an arm of our own design floor and weights come from builds that are drawn about its numbers.
Lengths, mounts, drums, gears and the common place of the holes are none of its builds: what they
change, the fitted numbers take up.

The questions: does the error of the folds left out rise without it by more than a floor, in size
and in share?  Surely, when half-second blocks are drawn again, by their mean or by their typical
fall?  And do the held-out trials agree?
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

import numpy as np
import scipy
from pydantic import ConfigDict, Field

from spirob.diagnosis.model import Model, Scored
from spirob.identify.builds import RESOLUTION, Builds, Floor, floor_of, weighted
from spirob.identify.fit import Fit
from spirob.identify.problem import Problem, effort_rms
from spirob.identify.residual import Residual

DRAWS = 2000
HALF = 0.5  # s, over which a residual is correlated at most
FAR = 10**9  # more half seconds than any trial has
HALVED = 0.5
UNSURE = 0.025  # share of the draws that may deny what is sure
TINY = 1e-300


def block_errors(residual: np.ndarray, edges: np.ndarray, block: int) -> np.ndarray:
    """Mean squared residual of each block of that many samples, none across trials, (B,)."""
    means = []
    for start, stop in pairwise(edges):
        for k in range(start, stop, block):
            means.append(np.mean(residual[k : min(k + block, stop)] ** 2))
    return np.array(means)


def half_seconds(problem: Problem) -> np.ndarray:
    """Number of the half second of its trial in which each sample of the effort lies, (n,).

    Motors of one trial share it: what disturbs one disturbs the other at the same time.
    """
    trials: dict[str, int] = {}
    found = []
    for piece in problem.stretches():
        trial = trials.setdefault(piece.trial, len(trials))
        found.append(trial * FAR + (piece.seconds / HALF).astype(int))
    return np.concatenate(found)


def foreseen(errors: np.ndarray, numbers: int, samples: int) -> np.ndarray:
    """Errors on fitted trials as they would be on new ones of the same kind, (B,).

    σ²·(1 + p/n)/(1 - p/n), p numbers fitted to n independent samples: final prediction error,
    Akaike, Annals of the Institute of Statistical Mathematics 21 (1969)
    """
    share = min(numbers / max(samples, 1), 0.9)
    return errors * (1.0 + share) / (1.0 - share)


def improvement(before: np.ndarray, after: np.ndarray, seed: int) -> tuple[float, float, float]:
    """Relative fall of the mean squared error with its 95 % interval; negative is worse."""
    drawn, again = _drawn(before, after, seed)
    low, high = np.quantile(1.0 - again.mean(axis=1) / drawn.mean(axis=1), [0.025, 0.975])
    return float(1.0 - after.mean() / before.mean()), float(low), float(high)


def _drawn(before: np.ndarray, after: np.ndarray, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Errors of blocks drawn again, `DRAWS` times: the same of both, (DRAWS, B) each.

    Where they are other blocks, as of rows that another delay leaves a partner, each draws its own.
    """
    draw = np.random.default_rng(seed)
    same = draw.integers(0, len(before), (DRAWS, len(before)))
    other = same if len(before) == len(after) else draw.integers(0, len(after), (DRAWS, len(after)))
    return before[same], after[other]


def noise_floor(problem: Problem) -> float:
    """RMS of the sensor noise that passes the residual's filter, in the unit of the effort.

    White noise of a sensor is taken from second differences of the raw effort, in which the slow
    signal all but vanishes (std of x_k - 2x_(k+1) + x_(k+2) is √6 σ; the median absolute deviation
    ignores the fast events); the filter lets through the share that it does of white noise, drawn
    as it was sampled.
    """
    white = np.random.default_rng(0).standard_normal(20_000)
    clock, spaced = np.arange(len(white)), problem.spaced()
    passed = {
        every: float(np.std(problem.filter(np.interp(clock, clock[::every], white[::every]))))
        for every in set(spaced)
    }
    levels = [
        passed[every] * 1.4826 * scipy.stats.median_abs_deviation(np.diff(raw, n=2)) / np.sqrt(6)
        for raw, every in zip(problem.raw(), spaced, strict=True)
    ]
    return float(np.sqrt(np.mean(np.square(levels))))


def complete(problem: Problem, floor: float) -> float:
    """RMS error of a model from which nothing is missing, in the unit of the effort.

    floor  what the build of a machine adds to the noise, over the RMS effort
    """
    return float(np.hypot(noise_floor(problem), floor * effort_rms(problem)))


def builds_at(changes: Mapping[str, float], names: Sequence[str], scale: float) -> Builds:
    """Builds of a machine with these numbers, of which the named are fitted.

    scale  of the robust loss
    """
    return Builds(changes, names, scale, {})


def floor_at(found: Fit, residuals: Mapping[str, Residual], scale: float) -> Floor:
    """The floor where these numbers were fitted."""
    builds = builds_at(found.changes, list(found.estimates), scale)
    return floor_of(residuals["train"], residuals["validate"], builds)


def weighed_at(
    changes: Mapping[str, float],
    names: Sequence[str],
    residuals: Mapping[str, Residual],
    scale: float,
) -> dict[str, Residual]:
    """The trials weighted by what builds of this machine differ by in them, by role."""
    right = complete(residuals["train"], RESOLUTION)
    return weighted(residuals, builds_at(changes, names, scale), right)


@dataclass(frozen=True)
class Criteria:
    """How the search decides: the key `criteria` of a description, or `settings` from Python.

    From which probability a name is given is `LIKELY` in `certainty`.

    floor      least size of an effect: √(fall of the mean square) over the RMS effort; more where
               the noise of the motion makes more of the modelled effort, or where builds of a
               machine that are drawn about it differ by more
    share      least fall of the squared error, relative
    veto       least fall of the squared error on held-out trials, relative
    better     relative fall of the square by which a model is preferred to one no poorer
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


@dataclass(frozen=True)
class Worth:
    """The questions; `least` is the size of the least effect, in the unit of the effort."""

    settings: Criteria
    least: float

    def matters(self, before: Scored, after: Scored) -> bool:
        """Whether `after` explains more by a size that counts, surely."""
        return self._falls(before, after, self.least)

    def _falls(self, before: Scored, after: Scored, least: float) -> bool:
        fall = before.mean_square - after.mean_square
        if fall <= 0.0 or np.sqrt(fall) < least:
            return False
        if fall < self.settings.share * before.mean_square:
            return False
        return self._surely(before, after)

    def clearly(self, before: Scored, after: Scored) -> bool:
        """Whether `after` is better than a rival by enough to be preferred to a simpler one."""
        if after.mean_square > (1.0 - self.settings.better) * before.mean_square:
            return False
        return self._surely(before, after)

    def halves(self, before: Scored, after: Scored) -> bool:
        """Whether `after` leaves less than half the squared error, held out too, and surely."""
        if after.mean_square > HALVED * before.mean_square:
            return False
        if after.heldout_square > HALVED * before.heldout_square:
            return False
        return self._surely(before, after)

    def _surely(self, before: Scored, after: Scored) -> bool:
        """Whether the fall holds when blocks are drawn again, of errors or of their logarithms.

        The logarithms weigh every block alike: one block with a blow in it decides nothing.
        """
        seed = self.settings.seed
        if improvement(before.errors, after.errors, seed)[1] > 0.0:
            return True
        drawn, again = _drawn(np.log(before.errors + TINY), np.log(after.errors + TINY), seed)
        return bool(np.quantile(drawn.mean(axis=1) - again.mean(axis=1), UNSURE) > 0.0)

    def possible(self, current: Model, error: float, promised: float) -> bool:
        """Whether an addition could matter, judged by its screened error.

        promised  share of the least effect that it has to promise
        """
        return current.mean_square - error > (promised * self.least) ** 2

    def denied(self, before: Scored, after: Scored, whole: bool = True) -> bool:
        """Whether the held-out trials contradict a step, or do not confirm one of a `whole` set."""
        least = 1.0 - (self.settings.veto if whole else 0.0)
        return after.heldout_square > least * before.heldout_square

    def refuted(self, model: Scored, other: Scored) -> bool:
        """Whether another leaves half of what the model leaves held out, less by what counts."""
        fall = model.heldout_square - other.heldout_square
        return fall > max((1.0 - HALVED) * model.heldout_square, self.least**2)

    def best(self, models: Sequence[Model]) -> Model:
        """The model that leaves least, of those that stand."""
        return min(self.standing(models), key=lambda m: m.mean_square)

    def simplest(self, models: Sequence[Model]) -> Model:
        """The poorest model to which no other is clearly preferable, of equals one that stands.

        A richer model has to be better by the least size of an effect: the edges of a smooth sign
        never fit quite, and a richer law always takes some of that.  And the held-out trials must
        not contradict it, as an addition.
        """
        best = min(models, key=lambda m: m.mean_square)
        equal = self.standing([m for m in models if m is best or not self._beaten(m, best)])
        return min(equal, key=lambda m: (len(m.effects), m.numbers, m.mean_square))

    def standing(self, models: Sequence[Model]) -> list[Model]:
        """Those that the held-out trials do not refute beside another of them.

        On logs of one direction dry friction is a constant force; one of the other direction tells.
        """
        return [m for m in models if not any(self.refuted(m, other) for other in models)]

    def _beaten(self, model: Model, best: Model) -> bool:
        if model.numbers >= best.numbers:
            return self.clearly(model, best)
        falls = self._falls(model, best, self.settings.richer * self.least)
        return falls and not self.rises(model, best)

    def rises(self, before: Scored, after: Scored) -> bool:
        """Whether the held-out error rises by what counts."""
        rise = after.heldout_square - before.heldout_square
        return rise > max(self.settings.veto * before.heldout_square, self.least**2)
