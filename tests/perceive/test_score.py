"""Scores in millimetres, defined for any number of samples.

Intervals over wraps.
"""

import math

import numpy as np
import pytest

from spirob.errors import DataError
from spirob.perceive.study import mean_error, mean_gain, score


def test_scores_are_the_definitions_in_millimetres():
    found = score([0.01, 0.02, 0.03], [0.011, 0.018, 0.033])
    assert found["mae"] == pytest.approx(2.0)
    assert found["rmse"] == pytest.approx(math.sqrt(14 / 3))
    assert found["std"] == pytest.approx(math.sqrt(200 / 3))
    assert found["r2"] == pytest.approx(1 - 14 / 200)


def test_predicting_the_mean_scores_zero():
    assert score([0.01, 0.02, 0.06], np.full(3, 0.03))["r2"] == pytest.approx(0.0)


def test_without_spread_there_is_no_r2():
    for true in ([0.03], [0.03, 0.03], [0.1 + 0.2, 0.3]):
        found = score(true, np.array(true) + 0.001)
        assert math.isnan(found["r2"])
        assert found["std"] == 0.0
        assert found["mae"] == pytest.approx(1.0)
    assert all(math.isnan(value) for value in score([], []).values())


def test_what_cannot_be_scored_is_told():
    with pytest.raises(DataError, match="2 true diameters cannot score 1"):
        score([0.01, 0.02], [0.01])
    with pytest.raises(DataError, match="not finite"):
        score([0.01, math.nan], [0.01, 0.02])


TRUE = np.linspace(0.01, 0.07, 200)
NOISE = np.random.default_rng(0).normal(0, 2e-3, 200)


def test_equal_errors_have_no_spread():
    assert mean_error(TRUE, TRUE + 1e-3) == pytest.approx((1.0, 1.0))


def test_it_narrows_with_the_root_of_the_number():
    narrow, wide = (np.ptp(mean_error(TRUE[:n], (TRUE + NOISE)[:n])) for n in (200, 50))
    assert 1.5 < wide / narrow < 2.7


def test_a_gain_on_the_same_wraps_is_surer_than_the_errors_themselves():
    worse, better = TRUE + NOISE, TRUE + 0.9 * NOISE
    low, high = mean_gain(TRUE, worse, better)
    assert 0 < low < 0.1 * mean_error(TRUE, worse)[1] < 2 * high
    assert mean_gain(TRUE, better, worse)[1] < 0


def test_the_same_seed_gives_the_same_interval():
    assert mean_error(TRUE, TRUE + NOISE, 3) == mean_error(TRUE, TRUE + NOISE, 3)
