"""A current that is held loses its noise; one that changes stays as it is."""

import numpy as np
import pytest

from spirob.machine.arm.steady import first_level, steadied

PERIOD, CUTOFF, NOISE = 1e-3, 30.0, 5e-3
T = np.arange(4000) * PERIOD


def measured(true, seed=0):
    return true + np.random.default_rng(seed).normal(0.0, NOISE, len(true))


@pytest.mark.parametrize("seed", range(5))
def test_holds_between_ramps(seed):
    true = np.interp(T, [0.5, 0.8, 2.4, 2.5], [0.0, 0.6, 0.6, 0.2])
    noisy = measured(true, seed)
    found = steadied(noisy, CUTOFF, PERIOD)
    held = ((T > 1.0) & (T < 2.2)) | (T > 2.8)
    assert np.std((found - true)[held]) < 0.1 * NOISE
    moving = ((T > 0.55) & (T < 0.75)) | ((T > 2.42) & (T < 2.48))
    np.testing.assert_array_equal(found[moving], noisy[moving])
    # a rotor adds a current up: what is wrong in a ramp has to be no more than its noise
    assert abs(np.sum(found - true)) * PERIOD < 5.0 * NOISE * PERIOD * np.sqrt(400)


def test_a_current_that_never_rests_is_as_it_was():
    noisy = measured(0.3 * np.sin(2 * np.pi * 2.0 * T))
    np.testing.assert_array_equal(steadied(noisy, CUTOFF, PERIOD), noisy)


def test_a_slow_drift_is_kept():
    true = 0.5 + 0.004 * T
    found = steadied(measured(true), CUTOFF, PERIOD)
    assert np.abs(found - true)[500:-500].max() < 0.3 * NOISE


@pytest.mark.parametrize("every", [2, 5])
def test_so_it_is_where_samples_are_further_apart_than_cycles(every):
    noisy = measured(np.full(len(T), 0.6))
    found = steadied(np.interp(T, T[::every], noisy[::every]), CUTOFF, PERIOD)
    assert np.std(found) < 0.2 * NOISE


def test_a_constant_is_itself():
    np.testing.assert_allclose(steadied(np.full(2000, 0.25), CUTOFF, PERIOD), 0.25, rtol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_where_a_current_begins_is_told_from_where_it_goes(seed):
    t = T[:50]
    for rest, change in ((0.08, 0.12 * (t > 0)), (0.3, 0.0 * t), (0.3, 8.0 * t**2 / T[50])):
        assert first_level(measured(rest + change, seed)) == pytest.approx(rest, abs=4.0 * NOISE)
    assert first_level(measured(8.0 * t**2 / T[50], seed)) == 0.0
    assert first_level(0.25 + 0.0 * t) == pytest.approx(0.25)
    assert first_level(0.0 * t) == 0.0
