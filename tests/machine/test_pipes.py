"""The effort behind a pipe: the same as the inverse where that is right, and bounded where not."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.machine.inverse.kernel_loop import nearby, solved, tangent

RNG = np.random.default_rng(3)
WANTED = RNG.uniform(-2.0, 2.0, 200)


def saturated(effort):
    return effort / np.sqrt(1.0 + 0.3 * effort**2)


def dead(effort):
    return np.sign(effort) * np.maximum(np.abs(effort) - 0.4, 0.0)


def rippled(effort):
    return effort * (1.0 + 0.2 * np.sin(np.arange(len(effort))))


@pytest.mark.parametrize("pipe", [saturated, dead, rippled])
def test_the_effort_that_makes_the_torque_stays_what_it_is(pipe):
    effort = RNG.uniform(-3.0, 3.0, 200)
    np.testing.assert_allclose(nearby(pipe, pipe(effort), effort), effort, atol=1e-12)


@settings(max_examples=30, deadline=None)
@given(st.floats(0.15, 5.0), st.integers(0, 1000))
def test_of_a_linear_pipe_it_is_the_inverse_from_anywhere(gain, seed):
    effort = np.random.default_rng(seed).normal(size=len(WANTED))
    found = nearby(lambda e: gain * e, WANTED, effort)
    np.testing.assert_allclose(found, WANTED / gain, atol=1e-9)


@pytest.mark.parametrize(("pipe", "noise"), [(rippled, 1e-9), (saturated, 0.01)])
def test_noise_of_the_measured_effort_passes_in_second_order(pipe, noise):
    """Of a ripple, linear in the effort, none; of saturation, what its slope changes by."""
    effort = RNG.uniform(-1.0, 1.0, 200)
    measured = effort + 0.01 * RNG.normal(size=200)
    found = nearby(pipe, pipe(effort), measured)
    assert np.abs(found - effort).max() < noise


def test_a_torque_nearby_is_told_to_first_order():
    """What is missed falls with the square of the distance, also for efforts of one sign."""
    effort = RNG.uniform(2.0, 3.0, 200)
    missed = [
        np.abs(nearby(saturated, saturated(effort + far), effort) - effort - far).max()
        for far in (0.02, 0.01)
    ]
    assert 3.5 < missed[0] / missed[1] < 4.5


def test_a_torque_beyond_all_efforts_is_not_far_away():
    """Iron gives 1.83 at most: the inverse runs off, a step from the measured effort does not."""
    wanted, effort = np.linspace(1.0, 2.2, 50), np.full(50, 3.0)
    assert np.abs(nearby(saturated, wanted, effort) - effort).max() < 10.0
    assert np.abs(solved(saturated, wanted)).max() > 100.0


def test_inside_a_dead_band_any_effort_makes_no_torque():
    effort = np.linspace(-0.39, 0.39, 21)
    np.testing.assert_allclose(nearby(dead, np.zeros(21), effort), effort, atol=1e-12)
    assert np.abs(solved(dead, np.zeros(21))).max() == 0.0


@pytest.mark.parametrize(("pipe", "share"), [(rippled, 1.0), (lambda e: 3.0 * e, 1.0)])
def test_what_a_gain_makes_of_an_effort_is_passed_on_whole(pipe, share):
    assert tangent(pipe, RNG.uniform(-2.0, 2.0, 500)).passing == share


@pytest.mark.parametrize("size", [1.0, 4.0])
def test_of_an_effort_of_one_size_a_dead_band_passes_what_is_beyond_it(size):
    relay = size * np.where(RNG.random(500) < 0.5, -1.0, 1.0)
    assert tangent(dead, relay).passing == pytest.approx(1.0 - 0.4 / size)
