"""How far a size model can be trusted: its errors on held-out sizes, and wraps unlike its own."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pandas as pd

from spirob.errors import DataError
from spirob.perceive.score import folds
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
    table: pd.DataFrame,
    settings: SizeSettings | None = None,
    predictor: str = "remainder",
    threads: int = 1,
) -> np.ndarray:
    """Diameters [m] predicted by stacks that never saw a wrap of that size, (n,).

    Up to `MOST_FOLDS` diameters are left out one by one, more of them in so many folds; the whole
    stack, its own folds included, is trained anew each time; `threads` of them side by side.
    Raises DataError with fewer than four diameters.
    """
    sizes = table[TARGET].to_numpy(float)
    if len(np.unique(sizes)) < 4:
        raise DataError("leaving one size out needs at least four diameters in the table")
    apart = folds(sizes, MOST_FOLDS)

    def one(fold: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        rows, hidden = fold
        return predict(train(table.iloc[rows], settings, predictor), table.iloc[hidden])

    out = np.zeros(len(table))
    with ThreadPoolExecutor(threads) as pool:
        for (_, hidden), found in zip(apart, pool.map(one, apart), strict=True):
            out[hidden] = found
    return out
