"""What a model lives on is told from what happens when it is taken away."""

import numpy as np
import pandas as pd
import pytest

from spirob.perceive.interval import MOST_FOLDS, held_out, used_features
from spirob.perceive.size import TARGET, predict, train
from spirob.perceive.study import gaussian_process, importance, learning_curve, rivals


def made_up(n, seed=0):
    """Sizes told by one feature well, by another badly, by a third not at all."""
    rng = np.random.default_rng(seed)
    size = rng.uniform(0.01, 0.07, n)
    columns = {
        "good": 0.1 - size + 3e-4 * rng.standard_normal(n),
        "poor": size + 5e-3 * rng.standard_normal(n),
        "noise": rng.standard_normal(n),
        TARGET: size,
    }
    return pd.DataFrame(columns, index=[f"w{k}" for k in range(n)])


def error(model, table):
    return 1e3 * np.abs(predict(model, table) - table[TARGET]).mean()


def test_the_feature_that_tells_is_the_important_one():
    model = train(made_up(120))
    found = importance(model, made_up(60, 1))
    assert next(iter(found)) == "good"
    assert found["good"] > 3 * abs(found["poor"])
    used = [n for n, kept in zip(model.features, used_features(model), strict=True) if kept]
    assert set(found) == set(used)


def test_more_samples_tell_better_and_the_last_step_is_the_model_itself():
    known, test = made_up(150), made_up(80, 1)
    curve = learning_curve(known, {"test": test})
    assert list(curve) == [20, 35, 50, 100, 150]
    assert curve[150]["test"]["mae"] < 0.8 * curve[20]["test"]["mae"]
    order = np.random.default_rng(0).permutation(150)
    assert curve[150]["test"]["mae"] == pytest.approx(error(train(known.iloc[order]), test))
    assert all(
        e["test"]["mae_low"] < e["test"]["mae"] < e["test"]["mae_high"] for e in curve.values()
    )


def test_rivals_know_what_they_should():
    known, listed, test = made_up(100), made_up(35, 2), made_up(50, 3)
    shipped = train(known)
    found = {n: told(test) for n, told in rivals(shipped, known, listed).items()}
    assert set(found) == {"ridge", "svr", "paper", "few", "gaussian_process", "mean"}
    assert np.array_equal(found["ridge"], predict(shipped, test, "ridge"))
    assert np.array_equal(found["few"], predict(train(listed), test))
    assert np.ptp(found["mean"]) == 0.0
    errors = {name: np.abs(v - test[TARGET]).mean() for name, v in found.items()}
    assert errors["gaussian_process"] < 0.2 * errors["mean"]


def test_a_gaussian_process_gives_the_same_bits_again():
    known, test = made_up(60), made_up(20, 1)
    assert np.array_equal(gaussian_process(known)(test), gaussian_process(known)(test))


def test_continuous_sizes_are_held_out_in_folds():
    known = made_up(70)
    found = held_out(known)
    assert np.isfinite(found).all()
    assert 1e3 * np.abs(found - known[TARGET]).mean() < 2.0
    # each was told by a model that never saw it: a wrong label does not reach its own prediction
    wrong = known.copy()
    wrong.iloc[5, -1] *= 1.000001
    assert held_out(wrong)[5] == pytest.approx(found[5], abs=1e-6)
    assert len(known) > MOST_FOLDS
