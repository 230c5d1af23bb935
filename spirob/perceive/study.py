"""How far a size model is from the truth, and what it lives on: features, samples, chosen numbers.

The shipped predictor is compared with others, none of which is used otherwise:

ridge, svr          each base model alone, on the same samples as the shipped predictor
paper               the paper's stack on the paper's samples
few                 the shipped kind of predictor on the paper's samples
gaussian_process    on the same samples as the shipped predictor, hyperparameters by likelihood
mean                the mean diameter of the training, whatever was wrapped

Numbers of the stack are chosen by the training alone.  Of every combination the base models are
trained on the folds, and the one with the least out-of-fold error is taken: the mean absolute error
of the blend on diameters that its folds held out, between the smallest and the largest, as those of
the ends are extrapolations.  No wrap that is tested has a say in it.
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
from sklearn.base import BaseEstimator, RegressorMixin

from spirob.errors import ConfigError, DataError
from spirob.perceive.interval import used_features
from spirob.perceive.size import (
    BASES,
    TARGET,
    Cut,
    MonotoneFeatures,
    SizeModel,
    SizeSettings,
    between,
    blended,
    feature_matrix,
    first_level,
    predict,
    train,
)

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


Predictor = Callable[[pd.DataFrame], np.ndarray]  # features of wraps -> diameters [m], (n,)


def rivals(shipped: SizeModel, known: pd.DataFrame, listed: pd.DataFrame) -> dict[str, Predictor]:
    """Every rival, trained.

    known   features that the shipped model was trained on;  listed  those of the paper's samples
    """
    # the shipped settings are those of many samples
    few = train(listed, SizeSettings(seed=shipped.settings.seed), "remainder")
    mean = float(known[TARGET].mean())
    return {
        **{name: partial(predict, shipped, predictor=name) for name in BASES},
        "paper": partial(predict, few, predictor="paper"),
        "few": partial(predict, few),
        "gaussian_process": gaussian_process(known, shipped.settings),
        "mean": lambda wraps: np.full(len(wraps), mean),
    }


def gaussian_process(known: pd.DataFrame, settings: SizeSettings | None = None) -> Predictor:
    """A Gaussian process with an RBF kernel and noise, trained.

    It gets the features of the base models, prepared as theirs are.
    """
    from sklearn.compose import TransformedTargetRegressor
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import StandardScaler

    settings = settings or SizeSettings()
    names = tuple(name for name in known.columns if name != TARGET)
    kernel = ConstantKernel(10.0) * RBF(5.0) + WhiteKernel(1e-3, (1e-8, 1.0))
    process = GaussianProcessRegressor(kernel, random_state=int(settings.seed))
    chosen = MonotoneFeatures(settings.threshold)
    model = TransformedTargetRegressor(
        make_pipeline(chosen, StandardScaler(), Cut(), process), transformer=StandardScaler()
    )
    with warnings.catch_warnings():
        # a hyperparameter at its bound is a fit all the same
        warnings.simplefilter("ignore", ConvergenceWarning)
        model.fit(feature_matrix(known, names), known[TARGET].to_numpy(float))
    return lambda wraps: np.asarray(model.predict(feature_matrix(wraps, names)))


def chosen(
    table: pd.DataFrame,
    settings: SizeSettings,
    among: Mapping[str, Sequence[float]],
    threads: int = 1,
) -> tuple[SizeSettings, list[dict[str, float]]]:
    """The settings with the least out-of-fold error, and every combination with its own [mm].

    table     features with the true `diameter` [m]
    among     values of each number to choose; the others stay as in `settings`
    threads   that try combinations side by side; how many changes no bit
    Of equal ones the first is taken.  Nothing to choose leaves the settings as they are.
    Raises ConfigError on an unknown number, one without values or out of range, and what `train`
    raises.
    """
    require_choices(among)
    if not among:
        return settings, []

    def one(values: Sequence[float]) -> dict[str, float]:
        numbers = dict(zip(among, map(float, values), strict=True))
        found = first_level(table, _with(settings, numbers))
        return {**numbers, "mae": out_of_fold_error(table, *found)}

    with ThreadPoolExecutor(threads) as pool:
        tried = list(pool.map(one, product(*among.values())))
    best = min(tried, key=lambda one: one["mae"])
    return _with(settings, {name: best[name] for name in among}), tried


def require_choices(among: Mapping[str, Sequence[float]]) -> None:
    """Raises ConfigError on an unknown number of the stack, one without values or out of range."""
    for name, values in among.items():
        if not values:
            raise ConfigError(f"choose: '{name}' has no values to choose from")
        for value in values:
            SizeSettings.from_mapping({name: value})


def out_of_fold_error(table: pd.DataFrame, level_one: np.ndarray, weight: float) -> float:
    """Mean absolute error of the blend on the held-out diameters of its training table [mm].

    level_one, weight  of `first_level`
    """
    true = table[TARGET].to_numpy(float)
    found = blended(level_one, weight)
    return float(MILLIMETRES * np.abs(found - true)[between(true)].mean())


def _with(settings: SizeSettings, numbers: Mapping[str, float]) -> SizeSettings:
    own = {name: getattr(settings, name) for name in settings.parameters()}
    replaced = SizeSettings.from_mapping({**own, **numbers})
    assert isinstance(replaced, SizeSettings)
    return replaced
