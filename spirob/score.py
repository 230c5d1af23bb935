"""Scores of a model, and how far each would move with other stretches of the same kind.

A score's spread is a bootstrap over blocks.  Errors of one moment resemble those of the next, so
whole blocks are drawn, never samples.  The model stays as it is: what another fit would do is not
in the interval.
"""

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


DRAWS = 2000
TAILS = 0.025, 0.975
MOST = 500  # blocks; where there are more, neighbours are joined

Interval = list[float | None]


def score_interval(
    measured: np.ndarray, predicted: np.ndarray, blocks: np.ndarray, seed: int = 0
) -> dict[str, Interval]:
    """95 % intervals [low, high] of "mae", "rmse" and "r2", as `score` defines them.

    measured, predicted  (N,), in one unit;  blocks  (N,) number of the block of each sample
    seed  of the draws: with one seed the same blocks are drawn of every model

    Of B blocks B - 1 are drawn with replacement, else the spread is too small by (B - 1)/B
    (Rao and Wu, Journal of the American Statistical Association 83, 1988).  Every score is a ratio
    of sums over blocks, so blocks may differ in length.  None where there is nothing to draw (one
    block) or R² has no value.
    """
    sums = _sums(np.asarray(measured), np.asarray(predicted), blocks)
    if len(sums) < 2:
        return {name: [None, None] for name in ("mae", "rmse", "r2")}
    count, size, square, level, power = _drawn(sums, seed).T
    with np.errstate(divide="ignore", invalid="ignore"):
        r2 = 1.0 - square / (power - level**2 / count)
    scores = {"mae": size / count, "rmse": np.sqrt(square / count), "r2": r2}
    return {name: _middle(values) for name, values in scores.items()}


def _sums(measured: np.ndarray, predicted: np.ndarray, blocks: np.ndarray) -> np.ndarray:
    """Σ1, Σ|e|, Σe², Σy, Σy² of each block, (B, 5); y is measured from its mean."""
    labels, block = np.unique(blocks, return_inverse=True)
    if len(labels) > MOST:
        block = block * MOST // len(labels)
    error, y = predicted - measured, measured - np.mean(measured)
    terms = (np.ones_like(error), np.abs(error), error**2, y, y**2)
    return np.column_stack([np.bincount(block, weights=t) for t in terms])


def _drawn(sums: np.ndarray, seed: int) -> np.ndarray:
    """The same sums over the blocks drawn, (DRAWS, 5)."""
    many = len(sums)
    drawn = np.random.default_rng(seed).integers(0, many, (DRAWS, many - 1))
    cells = (drawn + many * np.arange(DRAWS)[:, None]).ravel()
    times = np.bincount(cells, minlength=DRAWS * many).reshape(DRAWS, many)
    found: np.ndarray = times @ sums
    return found


def _middle(values: np.ndarray) -> Interval:
    """Ends of the middle 95 %; none where a draw has no value."""
    if not np.all(np.isfinite(values)):
        return [None, None]
    return [float(f"{v:.9g}") for v in np.quantile(values, TAILS)]
