"""Under which currents the arm rests as a log begins."""

import numpy as np
import pytest

from spirob.machine.arm.rest import BEGUN, RESTED, first_level, held, rests

NOISE = 5e-3  # A


def measured(true, seed=0):
    return true + np.random.default_rng(seed).normal(0.0, NOISE, len(true))


@pytest.mark.parametrize("seed", range(5))
def test_where_a_current_begins_is_told_from_where_it_goes(seed):
    t = 1e-3 * np.arange(50)
    for rest, change in ((0.08, 0.12 * (t > 0.005)), (0.3, 0.0 * t), (0.3, 8.0 * t**2 / 0.05)):
        assert first_level(measured(rest + change, seed))[0] == pytest.approx(rest, abs=4.0 * NOISE)
    assert first_level(measured(8.0 * t**2 / 0.05, seed)) == (0.0, 0.0)
    assert first_level(0.25 + 0.0 * t)[0] == pytest.approx(0.25)
    assert first_level(0.0 * t) == (0.0, 0.0)


def test_an_arm_without_currents_is_not_held():
    quiet = np.column_stack([measured(np.zeros(50), seed) for seed in (0, 1)])
    assert held(quiet) == (None, None)
    assert held(quiet + np.array([0.1, 0.0]))[0] == pytest.approx([0.1, 0.0], abs=NOISE)


def test_one_sample_says_nothing_of_a_current_that_goes_to_zero():
    assert first_level(np.array([0.05] + [0.0] * 49)) == (0.0, 0.0)


@pytest.mark.parametrize("lag", [0.0, 3e-3])
@pytest.mark.parametrize("to", [0.02, 0.16, 0.25])
def test_a_current_that_changes_at_once_begins_at_its_first_sample(to, lag):
    """Within its noise; how much of the change that sample holds is open."""
    t = 1e-3 * np.arange(50)
    share = 1.0 - np.exp(-t / lag) if lag else np.sign(t)
    true = 0.08 + (to - 0.08) * share
    found = np.array([first_level(measured(true, seed)) for seed in range(40)])
    missed, widths = np.abs(found[:, 0] - 0.08), found[:, 1]
    assert np.all(missed < np.minimum(4.0 * NOISE, widths))
    assert np.all(widths < 2.0 * abs(to - 0.08))


def test_a_current_that_comes_at_once_held_nothing_before():
    t = 1e-3 * np.arange(50)
    true = 0.2 * np.sign(t)
    found = np.array([first_level(measured(true, seed)) for seed in range(40)])
    assert np.mean(found[:, 0] == 0.0) > 0.9


def test_an_arm_is_held_by_both_where_one_changes_at_once():
    t = 1e-3 * np.arange(50)
    both = np.column_stack([measured(0.08 + 0.14 * np.sign(t)), measured(0.08 + 0.0 * t, 1)])
    assert held(both)[0] == pytest.approx([0.08, 0.08], abs=4.0 * NOISE)


@pytest.mark.parametrize("drift", [0.0, 1e-5, 1e-4])
def test_a_current_without_noise_begins_where_it_does(drift):
    """It drifts by some A in each ms."""
    level, _ = first_level(0.22 + drift * np.arange(50))
    assert level == pytest.approx(0.22, abs=max(2e-3 * 0.22, 3 * drift))


def test_the_longer_an_arm_stands_the_better_its_currents_are_known():
    t = 1e-3 * np.arange(4000)
    speed = np.where(t < 0.4, 0.0, 0.05 * np.sin(2 * np.pi * (t - 0.4)))
    stood = rests(np.column_stack([speed, 0.0 * t]))
    assert 400 <= stood < 420
    missed = [
        [first_level(measured(np.full(n, 0.2), seed))[0] - 0.2 for seed in range(40)]
        for n in (BEGUN, stood)
    ]
    assert np.std(missed[1]) < 0.6 * np.std(missed[0])
    assert rests(np.column_stack([0.05 + 0.0 * t, 0.0 * t])) == BEGUN
    assert rests(np.zeros((4000, 2))) == RESTED


@pytest.mark.parametrize("slope", [0.1, 0.3, 1.0])
def test_a_change_while_the_arm_still_stands_moves_no_level(slope):
    """A current may rise from 0.1 s on, in A/s, against an arm that hardly moves yet."""
    t = 2e-3 * np.arange(225)
    rising = 0.2 + slope * np.clip(t - 0.1, 0.0, None)
    found = np.array([first_level(measured(rising, seed)) for seed in range(40)])
    missed, widths = np.abs(found[:, 0] - 0.2), found[:, 1]
    assert np.mean(missed) < 1e-3
    assert np.mean(missed < widths) > 0.9
