"""Mean absolute error, root mean square error and coefficient of determination."""

from dataclasses import asdict, dataclass

import numpy as np


@dataclass(frozen=True)
class Score:
    """How far a prediction is from a measurement, in the unit of both.

    mae   Σ|m - p|/N;  rmse  √(Σ(m - p)²/N)
    r2    1 - Σ(m - p)²/Σ(m - mean(m))²; NaN where the measurement is constant
    """

    mae: float
    rmse: float
    r2: float

    def as_dict(self) -> dict[str, float | None]:
        """Plain numbers, rounded to 9 digits; an undefined R² is None."""
        return {k: None if np.isnan(v) else float(f"{v:.9g}") for k, v in asdict(self).items()}


def score(measured: np.ndarray, predicted: np.ndarray) -> Score:
    """Score a prediction; both (N,)."""
    error = np.asarray(predicted) - np.asarray(measured)
    spread = float(np.sum((measured - np.mean(measured)) ** 2))
    square = float(np.sum(error**2))
    r2 = 1.0 - square / spread if spread > 0 else float("nan")
    return Score(float(np.mean(np.abs(error))), float(np.sqrt(np.mean(error**2))), r2)
