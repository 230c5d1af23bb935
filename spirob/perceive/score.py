"""How far predicted diameters are from the true ones."""

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
