"""The training chooses numbers of the stack by errors on diameters that were held out."""

import numpy as np
import pandas as pd
import pytest
from sklearn.model_selection import GroupKFold, cross_val_predict

from spirob.errors import ConfigError
from spirob.perceive.size import TARGET, SizeSettings, base_models, first_level
from spirob.perceive.study import chosen, out_of_fold_error

SETTINGS = SizeSettings(trees=1, remainder_trees=0, folds=5)


@pytest.fixture(scope="module")
def curved():
    """A feature that follows the diameter by a curve, and one that has little to do with it."""
    rng = np.random.default_rng(0)
    size = rng.uniform(0.01, 0.07, 120)
    curve = np.tanh((size - 0.04) / 0.012)
    return pd.DataFrame({TARGET: size, "curve": curve, "loose": rng.normal(0, 1, 120) + 30 * size})


def test_nothing_to_choose_leaves_the_settings(curved):
    assert chosen(curved, SETTINGS, {}) == (SETTINGS, [])


def test_the_error_is_that_of_a_cross_validation(curved):
    size = curved[TARGET].to_numpy()
    names = [name for name in curved if name != TARGET]
    folds = GroupKFold(5).split(size[:, None], groups=np.rint(1e6 * size).astype(int))
    apart = list(folds)
    found = [
        cross_val_predict(one, curved[names].to_numpy(), size, cv=apart)
        for one in base_models(0.9, 1.0, 10.0, 0.02).values()
    ]
    inner = (size > size.min()) & (size < size.max())
    by_weight = [
        np.mean(np.square(w * found[0] + (1 - w) * found[1] - size)[inner])
        for w in np.linspace(0, 1, 10001)
    ]
    w = np.linspace(0, 1, 10001)[int(np.argmin(by_weight))]
    expected = 1e3 * np.mean(np.abs(w * found[0] + (1 - w) * found[1] - size)[inner])
    error = out_of_fold_error(curved, *first_level(curved, SETTINGS))
    assert error == pytest.approx(expected, rel=1e-3)


def test_the_least_error_is_taken_and_each_is_told(curved):
    among = {"svr_c": [0.01, 10.0], "svr_epsilon": [1.0, 0.02]}
    best, tried = chosen(curved, SETTINGS, among)
    # a curve that levels off asks for a narrow tube that is dear to leave
    assert (best.svr_c, best.svr_epsilon) == (10.0, 0.02)
    assert [(one["svr_c"], one["svr_epsilon"]) for one in tried] == [
        (0.01, 1.0),
        (0.01, 0.02),
        (10.0, 1.0),
        (10.0, 0.02),
    ]
    assert tried[-1]["mae"] == min(one["mae"] for one in tried)
    assert tried[-1]["mae"] == pytest.approx(out_of_fold_error(curved, *first_level(curved, best)))
    assert (best.trees, best.folds) == (SETTINGS.trees, SETTINGS.folds)


def test_a_feature_that_helps_is_let_in_and_one_that_misleads_is_not():
    rng = np.random.default_rng(1)
    size = rng.uniform(0.01, 0.07, 150)
    noise = rng.normal(0.0, 0.01, 150)
    # each alone is loose; together they cancel what disturbs them
    helps = pd.DataFrame({TARGET: size, **{f"f{k}": size for k in range(3)}})
    helps += np.outer(noise, [0, 1, 1, 1])
    helps["other"] = noise + 0.3 * size
    assert chosen(helps, SETTINGS, {"threshold": [0.9, 0.1]})[0].threshold == 0.1
    misleads = pd.DataFrame({TARGET: size, **{f"f{k}": size + 1e-4 * noise for k in range(3)}})
    for k in range(12):
        misleads[f"loose{k}"] = rng.normal(0.0, 1.0, 150)
    assert chosen(misleads, SETTINGS, {"threshold": [0.0, 0.9]})[0].threshold == 0.9


def test_threads_change_no_bit(curved):
    among = {"svr_c": [0.1, 10.0], "threshold": [0.9, 0.0]}
    assert chosen(curved, SETTINGS, among, threads=3) == chosen(curved, SETTINGS, among)


def test_of_equal_ones_the_first_is_taken(curved):
    best, tried = chosen(curved, SETTINGS, {"learning_rate": [0.3, 0.1]})
    assert tried[0]["mae"] == tried[1]["mae"]
    assert best.learning_rate == 0.3


@pytest.mark.parametrize(
    ("among", "said"),
    [
        ({"svr_c": []}, "'svr_c' has no values"),
        ({"colour": [1.0]}, "no number 'colour'"),
        ({"svr_c": [-1.0]}, "svr_c = -1"),
    ],
)
def test_a_mistake_is_told(curved, among, said):
    with pytest.raises(ConfigError, match=said):
        chosen(curved, SETTINGS, among)
