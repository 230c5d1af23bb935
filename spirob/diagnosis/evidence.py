"""Evidence: errors on trials that no fit has seen, above a noise that no model can explain.

Residuals of a simulation are autocorrelated, so errors are resampled in blocks of half a second;
what a block bootstrap cannot tell apart is not told apart.  Whether an effect counts, only trials
that were not fitted say.  Which of several it is, the fitted ones help to say, where their errors
are raised by what the fit has taken of them: two laws that a short validation hardly tells apart
may differ plainly in four trials more.

Of an arm of our own design floor and weights come from builds that are drawn about its numbers.
Lengths, mounts, drums, gears and the common place of the holes are none of its builds: what they
change, the fitted numbers take up.
"""

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from spirob.identify.builds import RESOLUTION, Builds, Floor, floor_of, weighted
from spirob.identify.fit import Fit
from spirob.identify.problem import Problem, effort_rms
from spirob.identify.residual import Residual

DRAWS = 2000
HALF = 0.5  # s, over which a residual is correlated at most
FAR = 10**9  # more half seconds than any trial has


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
    draws = np.random.default_rng(seed).integers(0, len(before), (DRAWS, len(before)))
    ratio = 1.0 - after[draws].mean(axis=1) / before[draws].mean(axis=1)
    low, high = np.quantile(ratio, [0.025, 0.975])
    return float(1.0 - after.mean() / before.mean()), float(low), float(high)


def noise_floor(problem: Problem) -> float:
    """RMS of the sensor noise that passes the residual's filter, in the unit of the effort.

    White noise of a sensor is taken from second differences of the raw effort, in which the slow
    signal all but vanishes (std of x_k - 2x_(k+1) + x_(k+2) is √6 σ; the median absolute deviation
    ignores the fast events); the filter lets through the share that it does of white noise.
    """
    white = np.random.default_rng(0).standard_normal(20_000)
    passed = float(np.std(problem.filter(white)))
    levels = [1.4826 * _deviation(np.diff(raw, n=2)) / np.sqrt(6) for raw in problem.raw()]
    return float(np.sqrt(np.mean(np.square(levels)))) * passed


def complete(problem: Problem, floor: float) -> float:
    """RMS error of a model from which nothing is missing, in the unit of the effort.

    floor  what the build of a machine adds to the noise, over the RMS effort
    """
    return float(np.hypot(noise_floor(problem), floor * effort_rms(problem)))


def _deviation(values: np.ndarray) -> float:
    return float(np.median(np.abs(values - np.median(values))))


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
