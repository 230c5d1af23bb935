"""Derivatives, the noise of a sensor, and a cutoff that keeps it small."""

import numpy as np
import pytest
from scipy import signal

from spirob.machine.filtering import before_thinning, derivative, smooth
from spirob.machine.motion_noise import acceleration_noise, sensor_noise, usual_cutoff


@pytest.mark.parametrize("order", [1, 3, 4])
def test_a_polynomial_of_fourth_order_is_differentiated_exactly(order):
    t = np.linspace(0, 1, 40)
    found = derivative(t**order, t[1] - t[0])
    np.testing.assert_allclose(found[2:-2], order * t[2:-2] ** (order - 1), atol=1e-9)


@pytest.mark.parametrize("count", [1, 2, 5, 31, 61, 400])
def test_the_filters_are_those_of_scipy_to_the_bit(count):
    values = np.random.default_rng(count).standard_normal(count)
    low = signal.butter(4, 25.0, fs=500.0, output="sos")
    expected = signal.sosfiltfilt(low, values, padlen=min(30, count - 1))
    np.testing.assert_array_equal(smooth(values, 25.0, 2e-3), expected)
    alias = signal.cheby1(8, 0.05, 0.8 / 4, output="sos")
    expected = signal.sosfiltfilt(alias, values, padlen=min(60, count - 1))
    np.testing.assert_array_equal(before_thinning(values, 4), expected)


@pytest.mark.parametrize("count", [2, 4, 5, 6, 40])
def test_the_ends_of_a_derivative_are_those_of_second_order(count):
    values = np.random.default_rng(count).standard_normal(count)
    found, expected = derivative(values, 1e-3), np.gradient(values, 1e-3)
    np.testing.assert_array_equal(found[[0, 1, -2, -1]], expected[[0, 1, -2, -1]])


def test_the_noise_of_an_encoder_is_its_step_over_the_root_of_twelve():
    t = np.arange(0, 10, 1e-3)
    q = np.sin(2 * np.pi * t)
    step = 2e-3
    assert sensor_noise(np.round(q / step) * step) == pytest.approx(step / np.sqrt(12), rel=0.3)


def test_the_cutoff_falls_until_noise_is_small():
    t = np.arange(0, 10, 1e-3)
    q = np.sin(2 * np.pi * t) + 0.2 * np.sin(7 * t)
    coarse = np.round(q / 2e-3) * 2e-3
    fine_cutoff, coarse_cutoff = (usual_cutoff(x, 2, -q, 1e-3) for x in (q, coarse))
    assert fine_cutoff == 50.0
    assert 4.0 <= coarse_cutoff < 30.0
    noise = acceleration_noise(coarse, 2, 50.0, 1e-3)
    left = derivative(derivative(smooth(coarse - q, 25.0, 1e-3), 1e-3), 1e-3)
    assert noise == pytest.approx(float(np.std(left)), rel=0.5)
