"""The size of a wrapped object from the features of its wrap: stacked regressors.

The base models, a linear and a kernel regressor, have one preparation.  It is learnt inside every
fold:

1. keep the features that rise or fall with the diameter.  The others are not only useless: in a
   simulation they hardly vary, so that scaling blows up any difference to a robot.
2. scale to mean 0 and deviation 1, and cut at ±`REACH` deviations: an RBF kernel far from all
   its samples falls back to the mean, and a line runs away.

Targets are metres divided by their deviation, so that penalties do not depend on the unit.

Ridge and an RBF support vector regressor are the base models; a gradient boosting learns from
their out-of-fold predictions (paper, "Object Size Estimation").  Folds hold whole diameters out,
so an out-of-fold prediction is always one for a size never seen.

The paper's meta-learner predicts the diameter itself.  Its trees are constant between the sizes
they were trained on: with seven sizes, a 15 mm cylinder becomes 10 or 20 mm.  So a second
predictor is offered and shipped: a convex blend of the base predictions, which interpolates, and
a boosting that learns only the remainder, which shall be small.

    paper      D = GB(ridge, svr)
    remainder  D = w·ridge + (1 - w)·svr + GB(ridge, svr),   0 <= w <= 1 by least squares
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import rankdata
from sklearn.base import BaseEstimator, TransformerMixin
from sklearn.compose import TransformedTargetRegressor
from sklearn.feature_selection import SelectorMixin
from sklearn.linear_model import Ridge
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVR

from spirob.errors import ConfigError, DataError
from spirob.parameter import Numbers, bounded

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
        ranks = rankdata(y)
        self.correlation_ = np.array([_rank_correlation(column, y, ranks) for column in x.T])
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


def _rank_correlation(values: np.ndarray, target: np.ndarray, ranks: np.ndarray) -> float:
    """Spearman's; ranks of the target.  Its test, which scipy adds, costs more than it does."""
    if np.ptp(values) == 0 or np.ptp(target) == 0:
        return 0.0
    both = np.column_stack([rankdata(values), ranks])
    return abs(float(np.corrcoef(both, rowvar=False)[1, 0]))


PREDICTORS = ("remainder", "paper")
TARGET = "diameter"
BASES = ("ridge", "svr")


class SizeSettings(Numbers):
    """Numbers of the stack; targets and features are scaled to deviation 1."""

    owner = "size"

    threshold: float = bounded(0.9, 0.0, 1.0, "1", "ρ_s", "least rank correlation of a feature")
    ridge_alpha: float = bounded(1.0, 1e-6, 1e6, "1", "α", "penalty of the ridge", log=True)
    svr_c: float = bounded(10.0, 1e-3, 1e4, "1", "C", "price of leaving the tube", log=True)
    svr_epsilon: float = bounded(0.02, 0.0, 1.0, "1", "ε", "half width of the tube")
    trees: float = bounded(100, 1, 5000, "1", "n", "boosting steps")
    learning_rate: float = bounded(0.1, 1e-3, 1.0, "1", "ν", "share taken of each step")
    depth: float = bounded(2, 1, 10, "1", "d", "depth of the trees")
    remainder_trees: float = bounded(10, 0, 5000, "1", "n_r", "steps that learn the remainder")
    remainder_depth: float = bounded(1, 1, 10, "1", "d_r", "depth of their trees")
    folds: float = bounded(10, 2, 100, "1", "k", "at most; never more than there are diameters")
    seed: float = bounded(0, 0, 2**31 - 1, "1", "s", "of the boosting")


@dataclass(frozen=True)
class SizeModel:
    """A trained stack.

    features      names of the columns, in order;  low, high  their range in training
    predictor     what `predict` uses: one of `PREDICTORS`, or a base model's name
    bases         fitted base models by name;  weight  w of the blend
    meta          predictor -> fitted boosting, None where it has no trees
    out_of_fold   (n, 2) base predictions from the folds [m], columns as `BASES`
    sizes         smallest and largest diameter in training [m]
    errors        sizes of its errors on wraps of diameters held out [m], ascending; empty until
                  `interval.calibrated` has found them
    """

    features: tuple[str, ...]
    low: np.ndarray
    high: np.ndarray
    predictor: str
    bases: dict[str, Any]
    weight: float
    meta: dict[str, Any]
    out_of_fold: np.ndarray
    settings: SizeSettings
    sizes: tuple[float, float]
    errors: np.ndarray = field(default_factory=lambda: np.zeros(0))


def train(
    table: pd.DataFrame, settings: SizeSettings | None = None, predictor: str = "remainder"
) -> SizeModel:
    """Train on features with the true `diameter` [m] as a column.

    Everything is trained; `predictor` is what `predict` uses.  The same table and
    settings give the same bits.  Raises ConfigError on an unknown predictor, DataError where
    values are missing or there are fewer than three diameters.
    """
    settings = settings or SizeSettings()
    _require_predictor(predictor)
    names, x, y = _known(table)
    level_one, weight = first_level(table, settings)
    bases, inner = _bases(settings), between(y)
    for model in bases.values():
        model.fit(x, y)
    remainder = y - blended(level_one, weight)
    trees, depth = int(settings.remainder_trees), int(settings.remainder_depth)
    meta = {
        "paper": _boosting(settings, int(settings.trees), int(settings.depth), level_one, y),
        "remainder": _boosting(settings, trees, depth, level_one[inner], remainder[inner]),
    }
    low, high = x.min(0), x.max(0)
    sizes = float(y.min()), float(y.max())
    return SizeModel(names, low, high, predictor, bases, weight, meta, level_one, settings, sizes)


def first_level(table: pd.DataFrame, settings: SizeSettings) -> tuple[np.ndarray, float]:
    """Base predictions from the folds [m], (n, 2), columns as `BASES`, and w of their blend.

    Of the ends' sizes out-of-fold predictions are extrapolations, which the finished model, that
    knows the ends, never makes; so they say nothing of how to blend.
    """
    _, x, y = _known(table)
    found, inner = _out_of_fold(x, y, settings), between(y)
    return found, _best_weight(found[inner], y[inner])


def between(diameters: np.ndarray) -> np.ndarray:
    """Which of them lie between the smallest and the largest, (n,)."""
    return (diameters > diameters.min()) & (diameters < diameters.max())


def _known(table: pd.DataFrame) -> tuple[tuple[str, ...], np.ndarray, np.ndarray]:
    """Names of the features, these (n, k), and the true diameters (n,) [m]."""
    if TARGET not in table:
        raise DataError(f"the table of features lacks the column '{TARGET}'")
    names = tuple(name for name in table.columns if name != TARGET)
    x, y = feature_matrix(table, names), table[TARGET].to_numpy(float)
    if not (np.isfinite(y).all() and (y > 0).all()):
        raise DataError("every diameter in the table must be above 0")
    return names, x, y


def predict(model: SizeModel, table: pd.DataFrame, predictor: str | None = None) -> np.ndarray:
    """Diameters [m] of the wraps in a table of features, (n,); other columns are ignored.

    predictor  'remainder', 'paper', or the name of one base model; the model's own where None
    Raises DataError where a feature of the model is missing or not finite.
    """
    chosen = predictor or model.predictor
    _require_predictor(chosen)
    x = feature_matrix(table, model.features)
    level_one = np.column_stack([model.bases[name].predict(x) for name in BASES])
    if chosen in BASES:
        return level_one[:, BASES.index(chosen)]
    start = blended(level_one, model.weight) if chosen == "remainder" else np.zeros(len(x))
    meta = model.meta[chosen]
    return start if meta is None else start + meta.predict(level_one)


def feature_matrix(table: pd.DataFrame, names: tuple[str, ...]) -> np.ndarray:
    """The named columns as (n, k); raises DataError where one is missing or not finite."""
    missing = [name for name in names if name not in table]
    if missing:
        raise DataError(f"the table of features lacks {', '.join(missing)}")
    if not len(table) or not names:
        raise DataError("the table of features is empty")
    x = table[list(names)].to_numpy(float)
    bad = ~np.isfinite(x)
    if bad.any():
        row, column = np.argwhere(bad)[0]
        raise DataError(f"{table.index[row]}: feature '{names[column]}' is {x[row, column]}")
    return x


def _bases(settings: SizeSettings) -> dict[str, Any]:
    from spirob.perceive.size import base_models

    s = settings
    return base_models(s.threshold, s.ridge_alpha, s.svr_c, s.svr_epsilon)


def _out_of_fold(x: np.ndarray, y: np.ndarray, settings: SizeSettings) -> np.ndarray:
    out = np.zeros((len(y), len(BASES)))
    for rows, hidden in folds(y, int(settings.folds)):
        for k, model in enumerate(_bases(settings).values()):
            out[hidden, k] = model.fit(x[rows], y[rows]).predict(x[hidden])
    return out


def _boosting(settings: SizeSettings, trees: int, depth: int, x: np.ndarray, y: np.ndarray) -> Any:
    from sklearn.ensemble import GradientBoostingRegressor

    if trees == 0:
        return None
    return GradientBoostingRegressor(
        n_estimators=trees,
        learning_rate=settings.learning_rate,
        max_depth=depth,
        random_state=int(settings.seed),
    ).fit(x, y)


def _best_weight(level_one: np.ndarray, y: np.ndarray) -> float:
    difference, rest = level_one[:, 0] - level_one[:, 1], y - level_one[:, 1]
    squares = float(difference @ difference)
    return float(np.clip(difference @ rest / squares, 0.0, 1.0)) if squares > 0 else 0.5


def blended(level_one: np.ndarray, weight: float) -> np.ndarray:
    """Convex blend of base predictions (n, 2) [m], columns as `BASES`; `weight` is the first's."""
    return weight * level_one[:, 0] + (1 - weight) * level_one[:, 1]


def _require_predictor(name: str) -> None:
    known = (*PREDICTORS, *BASES)
    if name not in known:
        raise ConfigError(f"no size predictor '{name}'; known: {', '.join(known)}")


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
