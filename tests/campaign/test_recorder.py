"""A log holds what its recorder says: late, counted, wrapped, uneven, noisy."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.campaign.recorder import SI, Recorder, columns, reported
from spirob.campaign.simulators.hidden import Hidden
from spirob.campaign.simulators.motion import FINE, Machine, Motion

PLAIN = Recorder(200.0, 10.0, 2, 0.0, 4096, False, 0.0, True, 1e-9, 0.0, 0.1, "rad", "N·m")
AXIS = Machine("any", True, 0.1, 0.1, "torque", 1.0, "measured", None, 12.0, 1.0)
T = np.arange(int(10 * FINE)) / FINE
MOTION = Motion(0.8 * T, np.full_like(T, 0.8), 1.0 + 2.0 * T)


def log(recorder, motion=MOTION):
    return columns(motion, AXIS, recorder, np.random.default_rng(0))


def test_the_effort_trails_by_the_delay():
    prompt, late = log(PLAIN), log(replace(PLAIN, delay=0.03))
    np.testing.assert_allclose(prompt["u"] - late["u"], 2.0 * 0.03, atol=1e-6)
    np.testing.assert_array_equal(prompt["q"], late["q"])


@pytest.mark.parametrize("place", ["rad", "deg", "turn", "tick"])
def test_positions_are_counted_in_their_unit_and_wrap(place):
    made = log(replace(PLAIN, place=place, counts=1024))
    size = 2 * np.pi / 1024 if place == "tick" else SI[place]
    exact = 0.8 * (made["t"] + 0.055)  # the log begins when all its signals do
    assert np.max(np.abs(made["q"] * size - exact)) <= np.pi / 1024 + 1e-9
    wrapped = log(replace(PLAIN, place=place, counts=1024, wraps=True))["q"] * size
    assert wrapped.max() < 2 * np.pi
    apart = (wrapped - exact + np.pi) % (2 * np.pi) - np.pi
    assert np.max(np.abs(apart)) <= np.pi / 1024 + 1e-9


def test_jitter_is_in_the_stamps_only_where_they_tell_it():
    even, told, hidden = (
        log(replace(PLAIN, jitter=j, stamped=s))
        for j, s in ((0.0, True), (0.2, True), (0.2, False))
    )
    np.testing.assert_allclose(np.diff(even["t"]), 1 / 200)
    np.testing.assert_allclose(np.diff(hidden["t"]), 1 / 200)
    assert 0.02 / 200 < np.std(np.diff(told["t"])) < 0.15 / 200
    np.testing.assert_array_equal(told["q"], hidden["q"])


def test_noise_is_of_the_size_that_is_asked_for():
    size = np.sqrt(np.mean(log(PLAIN)["u"] ** 2))
    for noise in ({"white": 0.02}, {"slow": 0.02}):
        left = log(replace(PLAIN, **noise))["u"] - log(PLAIN)["u"]
        assert np.std(left) / size == pytest.approx(0.02, rel=0.3)


def test_reports_are_off_by_what_is_hidden():
    told = reported(MOTION, AXIS, Hidden(offset=0.5, gain=0.1))
    np.testing.assert_allclose(told.effort, 1.1 * MOTION.effort + 0.5)
    late = reported(MOTION, AXIS, Hidden(latency=0.005))
    np.testing.assert_allclose(late.q[100:], MOTION.q[100:] - 0.8 * 0.005)
    lagged = reported(MOTION, AXIS, Hidden(lag=0.05))
    np.testing.assert_allclose(lagged.effort[5000:], MOTION.effort[5000:] - 2.0 * 0.05, atol=1e-3)
    bent = reported(MOTION, AXIS, Hidden(eccentric=0.02))
    np.testing.assert_allclose(bent.q - MOTION.q, 0.02 * np.sin(MOTION.q), atol=1e-12)
