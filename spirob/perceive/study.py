"""What a size model lives on: which features it needs, and how many samples."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from sklearn.base import BaseEstimator, RegressorMixin

from spirob.perceive.bootstrap import mean_error
from spirob.perceive.score import MILLIMETRES, score
from spirob.perceive.size import TARGET, SizeModel, SizeSettings, feature_matrix, predict, train
from spirob.perceive.trust import used_features

SHUFFLES = 10
STEPS = (20, 35, 50, 100, 200, 400, 800, 1600, 3200)  # samples


class _Trained(RegressorMixin, BaseEstimator):
    """A trained model in the shape that scikit-learn's inspection asks for."""

    def __init__(self, model: SizeModel):
        self.model = model

    def fit(self, x: Any, y: Any) -> "_Trained":
        return self

    def predict(self, x: Any) -> np.ndarray:
        return predict(self.model, pd.DataFrame(x, columns=list(self.model.features)))


def importance(model: SizeModel, table: pd.DataFrame) -> dict[str, float]:
    """By how much the mean absolute error grows when one feature is shuffled [mm], largest first.

    Features that the model does not use are left out.  Of features that say the same each looks
    little important, because the others still tell.
    """
    from sklearn.inspection import permutation_importance

    x, y = feature_matrix(table, model.features), table[TARGET].to_numpy(float)
    found = permutation_importance(
        _Trained(model),
        x,
        y,
        scoring="neg_mean_absolute_error",
        n_repeats=SHUFFLES,
        random_state=int(model.settings.seed),
    )
    grown = MILLIMETRES * found.importances_mean
    rows = zip(model.features, grown.tolist(), used_features(model), strict=True)
    told = {name: value for name, value, used in rows if used}
    return dict(sorted(told.items(), key=lambda item: -item[1]))


def learning_curve(
    table: pd.DataFrame,
    tests: Mapping[str, pd.DataFrame],
    settings: SizeSettings | None = None,
    predictor: str = "remainder",
) -> dict[int, dict[str, dict[str, float]]]:
    """Mean absolute error of each test by the number of training samples, with its interval.

    Each is {"mae", "mae_low", "mae_high"} [mm]; the interval is one over the test's wraps, and
    does not tell how much another draw of the samples would have moved it.
    The samples are the first ones of one drawn order, so that each step contains the one before
    it; the last is the whole table.
    """
    settings = settings or SizeSettings()
    order = np.random.default_rng(int(settings.seed)).permutation(len(table))
    steps = [n for n in STEPS if n < len(table)] + [len(table)]
    found = {}
    for n in steps:
        chosen = table.iloc[order[:n]]
        if chosen[TARGET].nunique() >= 3:
            model = train(chosen, settings, predictor)
            found[n] = {name: _errors(model, test) for name, test in tests.items()}
    return found


def _errors(model: SizeModel, table: pd.DataFrame) -> dict[str, float]:
    true, found = table[TARGET].to_numpy(float), predict(model, table)
    low, high = mean_error(true, found)
    return {"mae": score(true, found)["mae"], "mae_low": low, "mae_high": high}
