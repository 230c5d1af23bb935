"""How far a mean error of size would move with other wraps: a bootstrap over wraps."""

import numpy as np

from spirob.perceive.score import MILLIMETRES, score

DRAWS = 2000
CONFIDENCE = 0.95


def mean_error(true: np.ndarray, predicted: np.ndarray, seed: int = 0) -> tuple[float, float]:
    """95 % interval of the mean absolute error [mm].

    true, predicted  (n,) [m];  seed  of the draws
    """
    return _interval(np.abs(predicted - true), seed)


def scored(true: np.ndarray, predicted: np.ndarray, seed: int = 0) -> dict[str, float]:
    """What `score` tells, and the interval of the mean absolute error: mae_low, mae_high [mm]."""
    low, high = mean_error(true, predicted, seed)
    return {**score(true, predicted), "mae_low": low, "mae_high": high}


def mean_gain(
    true: np.ndarray, before: np.ndarray, after: np.ndarray, seed: int = 0
) -> tuple[float, float]:
    """95 % interval of how much the mean absolute error falls from one estimate to another [mm].

    Both are of the same wraps, so that what makes a wrap hard does not widen it.
    """
    return _interval(np.abs(before - true) - np.abs(after - true), seed)


def _interval(values: np.ndarray, seed: int) -> tuple[float, float]:
    rng = np.random.default_rng(seed)
    rows = rng.integers(0, len(values), (DRAWS, len(values)))
    tails = (1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2
    low, high = MILLIMETRES * np.quantile(values[rows].mean(axis=1), tails)
    return float(low), float(high)
