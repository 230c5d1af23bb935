"""Intervals over wraps."""

import numpy as np
import pytest

from spirob.perceive.score import mean_error, mean_gain

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
