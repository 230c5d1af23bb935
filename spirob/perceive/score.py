"""How far predicted diameters are from true ones, with other wraps, of sizes held out."""

import numpy as np

from spirob.errors import DataError

MILLIMETRES = 1e3


def score(true: np.ndarray, predicted: np.ndarray) -> dict[str, float]:
    """Errors of predicted diameters [m], as {"mae", "rmse", "r2", "std"}.

    mae, rmse  mean absolute and root mean square error [mm]
    std        deviation of the true diameters [mm]: what MAE and R² are to be judged by
    r2         1 - Σ(D - D̂)² / Σ(D - D̄)² [-]; NaN where the true diameters do not differ, as
               with fewer than two of them
    All are NaN for no sample.  Raises DataError where lengths differ or a value is not finite.
    """
    true, predicted = (np.atleast_1d(np.asarray(v, dtype=float)) for v in (true, predicted))
    if true.shape != predicted.shape or true.ndim != 1:
        raise DataError(f"{len(true)} true diameters cannot score {len(predicted)} predicted ones")
    if not (np.isfinite(true).all() and np.isfinite(predicted).all()):
        raise DataError("a diameter to be scored is not finite")
    if not len(true):
        return dict.fromkeys(("mae", "rmse", "r2", "std"), float("nan"))
    error = MILLIMETRES * (predicted - true)
    spread = float(np.std(true)) * MILLIMETRES
    # Equal diameters may differ in their last bit after an average; that is no spread.
    known = spread > 1e-9
    return {
        "mae": float(np.mean(np.abs(error))),
        "rmse": float(np.sqrt(np.mean(error**2))),
        "r2": 1.0 - float(np.mean(error**2)) / spread**2 if known else float("nan"),
        "std": spread if known else 0.0,
    }


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


def folds(diameters: np.ndarray, count: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Train and test rows of at most `count` folds that hold whole diameters out.

    Raises DataError with fewer than three diameters.
    """
    from sklearn.model_selection import GroupKFold

    groups = len(np.unique(diameters))
    if groups < 3:
        raise DataError(f"training a size model needs at least 3 diameters, the table has {groups}")
    splitter = GroupKFold(min(count, groups))
    return list(splitter.split(diameters[:, None], groups=np.rint(1e6 * diameters).astype(int)))
