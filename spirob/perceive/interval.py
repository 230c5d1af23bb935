"""An interval with every size, and a refusal where the model has no ground to stand on.

Split by size: the whole stack is trained anew without one diameter and predicts its wraps, for each
diameter between the smallest and the largest (ten folds of them where there are more).  With n such
errors |e| in ascending order,

    D ± |e|_(k),   k = ⌈(n + 1) c⌉

holds the true diameter with probability c or more, if a new wrap is like those held out (conformal
prediction: Vovk et al. 2005; leaving groups out: Barber et al. 2021).  It is not like them when it
was done by a robot that the simulation misses, so the coverage there is measured, not claimed.

A wrap is refused where a feature leaves its range in training by more than half its width, or the
size comes out further beyond the sizes of training than the interval is wide.
"""

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from spirob.errors import ConfigError, DataError
from spirob.perceive.size import (
    TARGET,
    SizeModel,
    SizeSettings,
    feature_matrix,
    folds,
    predict,
    train,
)

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


CONFIDENCE = 0.9


@dataclass(frozen=True)
class Estimate:
    """A diameter with its interval, all [m], or the reason why there is none.

    diameter, low, high  NaN where refused;  refusal  a sentence, empty where there is a size
    """

    diameter: float
    low: float
    high: float
    refusal: str = ""


def calibrated(model: SizeModel, table: pd.DataFrame, threads: int = 1) -> SizeModel:
    """The model with its errors on sizes held out of this training table.

    threads  that train side by side; how many changes no bit
    Raises DataError with fewer than four diameters.
    """
    true = table[TARGET].to_numpy(float)
    between = (true > model.sizes[0]) & (true < model.sizes[1])
    found = held_out(table, model.settings, model.predictor, threads)
    return replace(model, errors=np.sort(np.abs(found - true)[between]))


def supported(model: SizeModel) -> bool:
    """Whether enough wraps were held out for intervals of the usual confidence."""
    return _rank(model, CONFIDENCE) <= len(model.errors)


def half_width(model: SizeModel, confidence: float = CONFIDENCE) -> float:
    """Half width of the interval [m].

    Raises ConfigError where the confidence is none, DataError where the model was not calibrated
    or on too few wraps for it.
    """
    if not 0.0 < confidence < 1.0:
        raise ConfigError(f"a confidence lies between 0 and 1, not at {confidence}")
    n = len(model.errors)
    if n == 0:
        raise DataError("the size model was not calibrated, so it has no intervals; train it anew")
    k = _rank(model, confidence)
    if k > n:
        raise DataError(
            f"{n} held-out wraps support a confidence of at most {n / (n + 1):.3f}, "
            f"not {confidence:g}"
        )
    return float(model.errors[k - 1])


def _rank(model: SizeModel, confidence: float) -> int:
    """Which of the ascending errors is the half width."""
    return math.ceil((len(model.errors) + 1) * confidence - 1e-9)


def estimate(
    model: SizeModel, table: pd.DataFrame, confidence: float = CONFIDENCE
) -> list[Estimate]:
    """The size of each wrap in a table of features, with its interval, or a refusal.

    Raises DataError where a feature is missing or not finite, and what `half_width` raises.
    """
    width = half_width(model, confidence)
    sizes = predict(model, table)
    strange = unfamiliar(model, table)
    return [
        _one(model, str(row), float(size), width, strange.get(row, []))
        for row, size in zip(table.index, sizes, strict=True)
    ]


def _one(model: SizeModel, row: str, size: float, width: float, strange: list[str]) -> Estimate:
    smallest, largest = model.sizes
    nothing = float("nan")
    if strange:
        text = f"{row}: no size, because {', '.join(strange)} lie far outside the training range"
        return Estimate(nothing, nothing, nothing, text)
    if not smallest - width <= size <= largest + width:
        text = (
            f"{row}: no size, because {1e3 * size:.1f} mm lies outside the sizes of the training, "
            f"{1e3 * smallest:.0f} to {1e3 * largest:.0f} mm"
        )
        return Estimate(nothing, nothing, nothing, text)
    return Estimate(size, max(size - width, 0.0), size + width)


def coverage(estimates: list[Estimate], true: np.ndarray) -> dict[str, float]:
    """How many intervals hold the true diameter [m], of those that were given.

    covered, refused  shares [1];  width  mean full width [m];  samples  how many wraps
    """
    given = [(e, t) for e, t in zip(estimates, true, strict=True) if not e.refusal]
    held = [e.low <= t <= e.high for e, t in given]
    widths = [e.high - e.low for e, _ in given]
    return {
        "covered": float(np.mean(held)) if given else float("nan"),
        "refused": 1.0 - len(given) / len(estimates),
        "width": float(np.mean(widths)) if given else float("nan"),
        "samples": float(len(estimates)),
    }
