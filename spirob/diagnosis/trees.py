"""Boosted trees on data left out: what of a residual follows from given signals, by any law.

They share nothing with the effects of the library and obey no law; what they find on trials that
they were not fitted to is there to be explained.
"""

import numpy as np
from sklearn.ensemble import HistGradientBoostingRegressor

BLOCKS = 5  # folds of one or two trials


def folds_of(edges: np.ndarray) -> np.ndarray:
    """Label of the fold of each sample: its trial, or a block of the whole where trials are few."""
    trials = len(edges) - 1
    if trials >= 3:
        return np.repeat(np.arange(trials), np.diff(edges))
    samples = int(edges[-1])
    return np.arange(samples) * BLOCKS // samples


def tree() -> HistGradientBoostingRegressor:
    """The trees, not fitted yet; shallow and slow: noise must not look like structure."""
    return HistGradientBoostingRegressor(
        max_iter=60, learning_rate=0.1, max_leaf_nodes=12, min_samples_leaf=30, random_state=0
    )


def left_out(features: np.ndarray, residual: np.ndarray, folds: np.ndarray) -> np.ndarray:
    """What trees fitted to the other folds leave of each fold, (N,); features (N, F)."""
    out = np.empty_like(residual)
    for k in np.unique(folds):
        inside = folds == k
        found = tree().fit(features[~inside], residual[~inside])
        out[inside] = residual[inside] - found.predict(features[inside])
    return out


def worth(residual: np.ndarray, predicted: np.ndarray) -> float:
    """The factor, 0 to 1, with which predictions of folds left out come closest."""
    power = float(np.dot(predicted, predicted))
    return float(np.clip(np.dot(residual, predicted) / power, 0.0, 1.0)) if power > 0 else 0.0


def share(before: np.ndarray, after: np.ndarray) -> float:
    """Share of the squared residual that is gone, at least 0."""
    return max(0.0, 1.0 - float(np.sum(after**2) / max(np.sum(before**2), 1e-300)))
