"""The stack learns sizes from wraps, not from their labels' order, and always the same way."""

import numpy as np
import pytest

from spirob.emulator import EmulatedRobot
from spirob.errors import ConfigError, DataError
from spirob.logs.reader import read_log
from spirob.perceive.features import table
from spirob.perceive.interval import held_out, unfamiliar, used_features
from spirob.perceive.size import PREDICTORS, SizeSettings, folds, predict, train
from spirob.perceive.study import score
from spirob.plant import Rig
from spirob.trials import Trial, record
from spirob.trials.trial import wrap_trial
from tests.perceive.conftest import simulate


@pytest.fixture(scope="module")
def model(known):
    return train(known)


@pytest.fixture(scope="module")
def unseen(plant):
    rng = np.random.default_rng(1)
    plain = [wrap_trial(f"unseen_{k}", "heldout", 0.015 + 0.01 * k, {}, rng) for k in range(6)]
    return table([simulate(plant, given) for given in plain])


def test_folds_hold_whole_diameters_out(known):
    sizes = known["diameter"].to_numpy()
    seen = np.zeros(len(sizes), int)
    for rows, hidden in folds(sizes, 4):
        assert not set(sizes[rows]) & set(sizes[hidden])
        seen[hidden] += 1
    assert (seen == 1).all()
    assert len(folds(sizes, 100)) == 7


def test_out_of_fold_predictions_never_saw_their_size(known, model):
    hidden = known["diameter"] == 0.04
    other = known.copy()
    other.loc[hidden, "diameter"] = 0.041  # labels of one size do not reach its own predictions
    again = train(other)
    assert np.array_equal(again.out_of_fold[hidden], model.out_of_fold[hidden])
    assert not np.array_equal(again.out_of_fold[~hidden], model.out_of_fold[~hidden])


def test_the_same_table_gives_the_same_bits(known, model, unseen):
    again = train(known)
    for predictor in (*PREDICTORS, "ridge", "svr"):
        assert np.array_equal(predict(again, unseen, predictor), predict(model, unseen, predictor))


def test_unseen_sizes_are_told_within_a_few_millimetres(model, unseen):
    found = score(unseen["diameter"], predict(model, unseen))
    assert found["mae"] < 2.5
    assert found["r2"] > 0.95


def test_the_remainder_interpolates_where_the_paper_s_trees_cannot(model, unseen):
    errors = {p: score(unseen["diameter"], predict(model, unseen, p))["mae"] for p in PREDICTORS}
    assert errors["remainder"] < 0.7 * errors["paper"]


def test_sizes_left_out_are_told_too(known):
    found = score(known["diameter"], held_out(known))
    assert found["mae"] < 4.0
    assert found["r2"] > 0.93


def test_shuffled_labels_teach_nothing(known):
    shuffled = known.copy()
    shuffled["diameter"] = np.random.default_rng(3).permutation(known["diameter"])
    for threshold in (0.0, 0.9):
        found = held_out(shuffled, SizeSettings(threshold=threshold))
        assert score(shuffled["diameter"], found)["r2"] < 0.1


def test_the_emulated_robot_is_understood_without_retraining(model, tmp_path):
    robot, rng, traces = EmulatedRobot(seed=7), np.random.default_rng(2), []
    for size in (0.02, 0.04, 0.06):
        trial = Trial.from_plain(wrap_trial(f"robot_{1e3 * size:.0f}", "heldout", size, {}, rng))
        path = record(
            trial,
            robot,
            tmp_path / f"{trial.name}.mcap",
            Rig(),
        )
        traces.append(read_log(path))
    robot.close()
    found = table(traces)
    assert np.abs(predict(model, found) - found["diameter"]).max() < 6e-3
    assert unfamiliar(model, found) == {}


def test_a_wrap_unlike_all_others_is_named(known, model):
    strange = known.iloc[[0]].copy()
    strange["end_stroke"] = 0.15
    assert unfamiliar(model, strange) == {known.index[0]: ["end_stroke"]}
    assert 0.0 < predict(model, strange)[0] < 0.1
    assert used_features(model)[list(model.features).index("end_stroke")]


def test_bad_tables_are_told_in_a_sentence(known, model):
    with pytest.raises(DataError, match="lacks the column 'diameter'"):
        train(known.drop(columns="diameter"))
    with pytest.raises(DataError, match="at least 3 diameters, the table has 2"):
        train(known[known["diameter"] < 0.025])
    with pytest.raises(DataError, match="at least four diameters"):
        held_out(known[known["diameter"] < 0.035])
    with pytest.raises(DataError, match="lacks end_stroke"):
        predict(model, known.drop(columns="end_stroke"))
    broken = known.copy()
    broken.iloc[4, 2] = np.nan
    with pytest.raises(DataError, match=f"{known.index[4]}: feature '{known.columns[2]}' is nan"):
        train(broken)
    with pytest.raises(ConfigError, match="known: remainder, paper"):
        train(known, predictor="oracle")
    with pytest.raises(ConfigError, match="svr_c"):
        SizeSettings(svr_c=-1.0)
