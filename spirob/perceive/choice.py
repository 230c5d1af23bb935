"""Numbers of the stack, chosen by the training alone.

Of every combination the stack is trained, and the one with the least out-of-fold error is taken:
the mean absolute error of the blend on diameters that its folds held out, between the smallest and
the largest, as those of the ends are extrapolations.  No wrap that is tested has a say in it.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import product

import numpy as np
import pandas as pd

from spirob.errors import ConfigError
from spirob.perceive.score import MILLIMETRES
from spirob.perceive.size import TARGET, SizeModel, SizeSettings, blended, train


def chosen(
    table: pd.DataFrame,
    settings: SizeSettings,
    among: Mapping[str, Sequence[float]],
    threads: int = 1,
) -> tuple[SizeSettings, list[dict[str, float]]]:
    """The settings with the least out-of-fold error, and every combination with its own [mm].

    table     features with the true `diameter` [m]
    among     values of each number to choose; the others stay as in `settings`
    threads   that train combinations side by side; how many changes no bit
    Of equal ones the first is taken.  Nothing to choose leaves the settings as they are.
    Raises ConfigError on an unknown number, one without values or out of range, and what `train`
    raises.
    """
    require_choices(among)
    if not among:
        return settings, []

    def one(values: Sequence[float]) -> dict[str, float]:
        numbers = dict(zip(among, map(float, values), strict=True))
        found = train(table, _with(settings, numbers))
        return {**numbers, "mae": out_of_fold_error(found, table)}

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


def out_of_fold_error(model: SizeModel, table: pd.DataFrame) -> float:
    """Mean absolute error of the blend on the held-out diameters of its training table [mm]."""
    true = table[TARGET].to_numpy(float)
    between = (true > model.sizes[0]) & (true < model.sizes[1])
    found = blended(model.out_of_fold, model.weight)
    return float(MILLIMETRES * np.abs(found - true)[between].mean())


def _with(settings: SizeSettings, numbers: Mapping[str, float]) -> SizeSettings:
    own = {name: getattr(settings, name) for name in settings.parameters()}
    replaced = SizeSettings.from_mapping({**own, **numbers})
    assert isinstance(replaced, SizeSettings)
    return replaced
