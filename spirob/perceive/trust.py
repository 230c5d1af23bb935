"""How far a size model can be trusted: its errors on held-out sizes, and wraps unlike its own."""

from typing import Any

import numpy as np
import pandas as pd

from spirob.errors import DataError
from spirob.perceive.folds import folds
from spirob.perceive.size import TARGET, SizeModel, SizeSettings, feature_matrix, predict, train

MOST_FOLDS = 10


def unfamiliar(model: SizeModel, table: pd.DataFrame) -> dict[Any, list[str]]:
    """Rows whose used features leave the training range by more than half its width.

    The index of the row -> names of those features; such a prediction deserves no trust.
    """
    x = feature_matrix(table, model.features)
    margin = 0.5 * (model.high - model.low)
    outside = (x < model.low - margin) | (x > model.high + margin)
    outside &= used_features(model)
    return {
        row: [name for name, bad in zip(model.features, found, strict=True) if bad]
        for row, found in zip(table.index, outside, strict=True)
        if found.any()
    }


def used_features(model: SizeModel) -> np.ndarray:
    """Which of the model's features its base models use, (n,) bool."""
    return model.bases["ridge"].regressor_[0].get_support()


def held_out(
    table: pd.DataFrame, settings: SizeSettings | None = None, predictor: str = "remainder"
) -> np.ndarray:
    """Diameters [m] predicted by stacks that never saw a wrap of that size, (n,).

    Up to `MOST_FOLDS` diameters are left out one by one, more of them in so many folds; the whole
    stack, its own folds included, is trained anew each time.
    Raises DataError with fewer than four diameters.
    """
    sizes = table[TARGET].to_numpy(float)
    if len(np.unique(sizes)) < 4:
        raise DataError("leaving one size out needs at least four diameters in the table")
    out = np.zeros(len(table))
    for rows, hidden in folds(sizes, MOST_FOLDS):
        model = train(table.iloc[rows], settings, predictor)
        out[hidden] = predict(model, table.iloc[hidden])
    return out
