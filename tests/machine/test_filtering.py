"""Derivatives, the noise of a sensor, and a cutoff that keeps it small."""

import numpy as np
import pytest

from spirob.machine.filtering import derivative, smooth
from spirob.machine.motion_noise import acceleration_noise, sensor_noise, usual_cutoff


@pytest.mark.parametrize("order", [1, 3, 4])
def test_a_polynomial_of_fourth_order_is_differentiated_exactly(order):
    t = np.linspace(0, 1, 40)
    found = derivative(t**order, t[1] - t[0])
    np.testing.assert_allclose(found[2:-2], order * t[2:-2] ** (order - 1), atol=1e-9)


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
