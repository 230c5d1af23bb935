"""Predictors that the shipped one is compared with; none of them is used otherwise.

ridge, svr          each base model alone, on the same samples as the shipped predictor
paper               the paper's stack on the paper's samples
few                 the shipped kind of predictor on the paper's samples
gaussian_process    on the same samples as the shipped predictor, hyperparameters by likelihood
mean                the mean diameter of the training, whatever was wrapped
"""

import warnings

import numpy as np
import pandas as pd

from spirob.perceive.base_models import Cut, MonotoneFeatures
from spirob.perceive.size import (
    BASES,
    TARGET,
    SizeModel,
    SizeSettings,
    feature_matrix,
    predict,
    train,
)


def rivals(
    shipped: SizeModel, known: pd.DataFrame, listed: pd.DataFrame, wraps: pd.DataFrame
) -> dict[str, np.ndarray]:
    """Every rival's diameters [m] of some wraps, (n,) each.

    known   features that the shipped model was trained on;  listed  those of the paper's samples
    """
    # the shipped settings are those of many samples
    few = train(listed, SizeSettings(seed=shipped.settings.seed), "remainder")
    return {
        **{name: predict(shipped, wraps, name) for name in BASES},
        "paper": predict(few, wraps, "paper"),
        "few": predict(few, wraps),
        "gaussian_process": gaussian_process(known, wraps, shipped.settings),
        "mean": np.full(len(wraps), float(known[TARGET].mean())),
    }


def gaussian_process(
    known: pd.DataFrame, wraps: pd.DataFrame, settings: SizeSettings | None = None
) -> np.ndarray:
    """Diameters [m] by a Gaussian process with an RBF kernel and noise, (n,).

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
    return np.asarray(model.predict(feature_matrix(wraps, names)))
