"""A trace guards its time base; the moving average is the filter of the paper's set-up."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spirob.errors import DataError, MissingChannel, TooShort
from spirob.logs.trace import Trace, moving_average

RATE = 1000.0  # Hz
WINDOW = 100


def trace(time_ns, **signals):
    return Trace("t", np.array(time_ns, np.int64), signals, dict.fromkeys(signals, "A"))


@given(st.lists(st.floats(-10, 10), min_size=5, max_size=60), st.integers(1, 5))
def test_moving_average_is_the_mean_of_the_last_samples(values, window):
    got = moving_average(np.array(values), window)
    direct = [np.mean(values[max(0, k + 1 - window) : k + 1]) for k in range(len(values))]
    np.testing.assert_allclose(got, direct, atol=1e-12)


def test_a_ramp_comes_out_half_a_window_late():
    ramp = np.arange(500.0)
    late = ramp - moving_average(ramp, WINDOW)
    np.testing.assert_allclose(late[WINDOW:], (WINDOW - 1) / 2)  # 49.5 ms at 1 kHz


@pytest.mark.parametrize("harmonic", [1, 2, 3])
def test_ten_hertz_and_its_harmonics_vanish(harmonic):
    t = np.arange(2000) / RATE
    wave = np.sin(2 * np.pi * 10 * harmonic * t + 0.3)
    assert np.abs(moving_average(wave, WINDOW)[WINDOW:]).max() < 1e-12


def test_frequencies_between_the_nulls_pass():
    t = np.arange(2000) / RATE
    assert np.abs(moving_average(np.sin(2 * np.pi * 5 * t), WINDOW)[WINDOW:]).max() > 0.6


def test_a_signal_shorter_than_the_window_is_refused_by_name():
    with pytest.raises(TooShort, match=r"hold_3: 99 samples.*100-sample"):
        moving_average(np.zeros(99), 100, "hold_3")


def test_time_must_increase_strictly():
    with pytest.raises(DataError, match="does not increase"):
        trace([0, 1, 1], a=np.zeros(3))


def test_channels_have_the_length_of_time():
    with pytest.raises(DataError, match="'a' has 2 samples"):
        trace([0, 1, 2], a=np.zeros(2))


def test_a_missing_channel_lists_what_is_there():
    assert str(MissingChannel("log", "b", ["a", "a"])).endswith("present: a")
    with pytest.raises(MissingChannel, match="'b' is missing; present: a"):
        trace([0, 1], a=np.zeros(2))["b"]


def test_seconds_and_period_follow_from_nanoseconds():
    sampled = trace([5_000_000, 6_000_000, 7_000_000], a=np.zeros(3))
    np.testing.assert_allclose(sampled.seconds, [0, 1e-3, 2e-3])
    assert sampled.period == pytest.approx(1e-3)
    assert len(sampled) == 3


def test_a_period_needs_two_samples():
    with pytest.raises(TooShort, match="sampling period"):
        _ = trace([0], a=np.zeros(1)).period


def test_non_finite_samples_are_counted():
    with pytest.raises(DataError, match="'a' holds 2 non-finite"):
        trace([0, 1, 2], a=np.array([np.nan, 0.0, np.inf])).require_finite(["a"])
