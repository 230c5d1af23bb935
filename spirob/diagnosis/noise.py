"""The noise floor: what no model could explain."""

import numpy as np

from spirob.identify.problem import Problem, effort_rms


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
