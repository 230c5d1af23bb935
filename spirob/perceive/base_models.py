"""The base models of the stack: a linear and a kernel regressor behind the same preparation.

Preparation is learnt inside every fold:

1. keep the features that rise or fall with the diameter.  The others are not only useless: in a
   simulation they hardly vary, so that scaling blows up any difference to a robot.
2. scale to mean 0 and deviation 1, and cut at ±`REACH` deviations: an RBF kernel far from all
   its samples falls back to the mean, and a line runs away.

Targets are metres divided by their deviation, so that penalties do not depend on the unit.
"""

from typing import Any

import numpy as np
from scipy.stats import spearmanr
from sklearn.base import BaseEstimator, TransformerMixin
from sklearn.compose import TransformedTargetRegressor
from sklearn.feature_selection import SelectorMixin
from sklearn.linear_model import Ridge
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVR

REACH = 3.0  # deviations; samples spread evenly over a range end at 1.7


class MonotoneFeatures(SelectorMixin, BaseEstimator):
    """Keeps features with a Spearman rank correlation of at least `threshold` with the target.

    Where fewer than `least` reach it, the `least` best are kept.
    """

    def __init__(self, threshold: float = 0.9, least: int = 3):
        self.threshold = threshold
        self.least = least

    def fit(self, x: Any, y: Any) -> "MonotoneFeatures":
        x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
        self.n_features_in_ = x.shape[1]
        self.correlation_ = np.array([_rank_correlation(column, y) for column in x.T])
        best = np.argsort(-self.correlation_, kind="stable")[: self.least]
        self.kept_ = self.correlation_ >= self.threshold
        self.kept_[best] = True
        return self

    def _get_support_mask(self) -> np.ndarray:
        return self.kept_


class Cut(TransformerMixin, BaseEstimator):
    """Cuts scaled features at ±`reach`."""

    def __init__(self, reach: float = REACH):
        self.reach = reach

    def fit(self, x: Any, y: Any = None) -> "Cut":
        self.n_features_in_ = np.shape(x)[1]
        return self

    def transform(self, x: Any) -> np.ndarray:
        return np.clip(x, -self.reach, self.reach)


def base_models(threshold: float, ridge_alpha: float, svr_c: float, svr_epsilon: float) -> dict:
    """Unfitted base models by name; settings as in `size.SizeSettings`."""
    regressors = {
        "ridge": Ridge(alpha=ridge_alpha),
        "svr": SVR(kernel="rbf", C=svr_c, epsilon=svr_epsilon, gamma="scale"),
    }
    return {
        name: TransformedTargetRegressor(
            make_pipeline(MonotoneFeatures(threshold), StandardScaler(), Cut(), regressor),
            transformer=StandardScaler(),
        )
        for name, regressor in regressors.items()
    }


def _rank_correlation(values: np.ndarray, target: np.ndarray) -> float:
    if np.ptp(values) == 0 or np.ptp(target) == 0:
        return 0.0
    return abs(float(spearmanr(values, target).statistic))
