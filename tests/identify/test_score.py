"""Intervals of scores hold the true score about as often as they say, for errors with a memory."""

import numpy as np
import pytest
from scipy.signal import lfilter

from spirob.identify.intervals import MOST, score, score_interval

BLOCK, MEMORY = 50, 0.9  # samples; correlation of one sample with the next
RMS = 1.0 / np.sqrt(1.0 - MEMORY**2)
SPREAD = 3.0  # of what is measured, white


def recording(rng, blocks=60):
    """Measurement and prediction, whose error is a first-order autoregression."""
    samples = BLOCK * blocks
    error = lfilter([1.0], [1.0, -MEMORY], rng.normal(size=samples + 500))[500:]
    measured = SPREAD * rng.normal(size=samples)
    return measured, measured + error


def coverage(block):
    """How often the interval holds the true score, by score."""
    rng, repeats = np.random.default_rng(7), 200
    true = {"mae": RMS * np.sqrt(2 / np.pi), "rmse": RMS, "r2": 1 - (RMS / SPREAD) ** 2}
    held = dict.fromkeys(true, 0)
    for _ in range(repeats):
        measured, predicted = recording(rng)
        found = score_interval(measured, predicted, np.arange(len(measured)) // block)
        for name, value in true.items():
            held[name] += found[name][0] <= value <= found[name][1]
    return {name: count / repeats for name, count in held.items()}


def test_the_interval_holds_the_true_score_nearly_as_often_as_it_says():
    for name, rate in coverage(BLOCK).items():
        assert 0.89 <= rate <= 0.99, name  # three standard errors of 200 repeats on either side


def test_samples_drawn_one_by_one_would_promise_too_much():
    assert coverage(6)["rmse"] < 0.8


def test_the_score_lies_inside():
    measured, predicted = recording(np.random.default_rng(1))
    found = score_interval(measured, predicted, np.arange(len(measured)) // BLOCK)
    for name, value in score(measured, predicted).as_dict().items():
        assert found[name][0] < value < found[name][1]


def test_a_constant_error_has_no_width():
    measured = np.random.default_rng(2).normal(size=1010)  # the last block is shorter
    found = score_interval(measured, measured - 0.25, np.arange(1010) // BLOCK)
    assert found["mae"] == pytest.approx([0.25, 0.25], abs=1e-8)
    assert found["rmse"] == pytest.approx([0.25, 0.25], abs=1e-8)
    assert score_interval(measured, measured, np.arange(1010) // BLOCK)["r2"] == [1.0, 1.0]


def test_four_times_the_data_halve_the_width():
    rng = np.random.default_rng(3)
    widths = []
    for blocks in (40, 160):
        found = [
            score_interval(*recording(rng, blocks), np.repeat(np.arange(blocks), BLOCK))["rmse"]
            for _ in range(40)
        ]
        widths.append(np.mean([high - low for low, high in found]))
    assert widths[0] / widths[1] == pytest.approx(2.0, rel=0.1)


def test_what_cannot_be_told_is_none():
    measured, predicted = recording(np.random.default_rng(4))
    one = score_interval(measured, predicted, np.zeros(len(measured)))
    assert set(map(tuple, one.values())) == {(None, None)}
    flat = score_interval(np.ones(100), np.ones(100) + 0.1, np.arange(100) // 10)
    assert flat["r2"] == [None, None]
    assert flat["mae"] == pytest.approx([0.1, 0.1])


def test_more_blocks_than_are_drawn_are_joined_in_their_order():
    rng = np.random.default_rng(5)
    measured, predicted = recording(rng, 2 * MOST)
    fine = np.arange(len(measured)) // BLOCK
    assert score_interval(measured, predicted, fine) == score_interval(
        measured, predicted, fine // 2
    )


def test_one_seed_gives_the_same_bits_and_others_move_them():
    measured, predicted = recording(np.random.default_rng(6))
    blocks = np.arange(len(measured)) // BLOCK
    first = score_interval(measured, predicted, blocks)
    assert score_interval(measured, predicted, blocks) == first
    assert score_interval(measured, predicted, blocks, seed=1) != first
