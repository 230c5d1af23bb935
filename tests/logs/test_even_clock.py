"""The even clock behind stamps is found to within half a sample, however they were made.

Of clocks coarser than the samples that holds for 99 of 100.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.logs.stamps import even_clock


def off(stamps, true, period):
    """Samples by which the found clock is off the true one; a common delay tells nothing."""
    found = even_clock(stamps)
    even = found.given if found.even is None else found.even
    late = even - true
    assert found.period == pytest.approx(period, rel=0.02)
    return float(np.max(np.abs(late - np.median(late))) / period)


@pytest.mark.parametrize("cut", [np.floor, np.ceil, np.round])
def test_a_coarse_clock(cut):
    """Half a sample; where rows to a stamp are nearly a whole number, always less than one.

    The beat of the two clocks is then longer than the log, so a stamp tells less of its rows.
    Fewer than 25 stamps do not tell the period well enough, so no more than 40 rows share one.
    """
    draws, missed = np.random.default_rng(7), []
    for rate, rows, begin in draws.uniform((20, 1.2, 0), (2000, 40, 1), (300, 3)):
        true = (begin + np.arange(1000)) / rate
        missed.append(off(rows / rate * cut(true * rate / rows), true, 1 / rate))
    assert np.quantile(missed, 0.99) < 0.5
    assert max(missed) < 1.0


@given(st.floats(20, 2000), st.integers(2, 60), st.floats(0.0, 1e-2))
def test_rows_that_come_in_bursts(rate, rows, within):
    index = np.arange(1200)
    stamps = (index // rows * rows + within * (index % rows)) / rate
    assert off(stamps, index / rate, 1 / rate) < 0.5


@settings(deadline=None)
@given(
    st.floats(20, 2000),
    st.sampled_from(["exponential", "uniform", "normal"]),
    st.floats(0.05, 0.8),
    st.integers(0, 2**32),
)
def test_stamps_that_are_late(rate, law, size, seed):
    rng = np.random.default_rng(seed)
    late = size * np.abs(getattr(rng, law)(size=1000)) / rate
    true = np.arange(1000) / rate
    assert off(np.maximum.accumulate(true + late), true, 1 / rate) < 0.5


@given(st.floats(20, 2000), st.integers(100, 800), st.integers(5, 30))
def test_rows_catch_up_after_a_stall(rate, at, samples):
    true = np.arange(1000) / rate
    stamps = true.copy()
    stamps[at : at + samples] = true[at + samples] + 1e-3 * np.arange(samples) / samples / rate
    stamps += 0.3 / rate * np.random.default_rng(at).random(1000)
    assert off(np.maximum.accumulate(stamps), true, 1 / rate) < 0.5


@given(st.floats(20, 2000), st.floats(0, 0.3), st.integers(0, 2**32))
def test_lost_samples_leave_an_even_clock_as_it_is(rate, share, seed):
    keep = np.random.default_rng(seed).random(1000) >= share
    true = np.arange(1000)[keep] / rate
    found = even_clock(true)
    assert found.even is None
    np.testing.assert_array_equal(found.given, true)
    assert found.period == pytest.approx(1 / rate, rel=1e-6)


@given(st.floats(20, 2000), st.integers(2, 8), st.floats(0.1, 30.0))
def test_a_gap_in_a_coarse_clock_stays(rate, rows, gap):
    true = np.arange(1000) / rate + gap * (np.arange(1000) >= 500)
    if gap * rate < 8 * rows:
        return
    tick = rows / rate
    assert off(tick * np.floor(true / tick + 1e-9), true, 1 / rate) < 1.0 * rows
