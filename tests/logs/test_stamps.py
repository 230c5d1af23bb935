"""Stamps come in order, whatever the counter and the way of the rows, or are refused.

The even clock behind stamps is found to within half a sample, however they were made.

Of clocks coarser than the samples that holds for 99 of 100.
"""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from spirob.errors import DataError
from spirob.logs.stamps import even_clock, ordered

PERIOD = 5.0  # ms


def clock(count=400, start=0.0):
    return start + PERIOD * np.arange(count)


@given(
    st.sampled_from([2.0**16, 2.0**24, 2.0**32, 2.0**32 * 1e-3, 1000.0, 86400e3]),
    st.floats(0.0, 1.0),
    st.booleans(),
)
def test_a_counter_that_wraps_goes_on(modulus, begin, centred):
    true = clock(min(400, int(0.9 * modulus / PERIOD)), begin * modulus)
    wrapped = true % modulus
    if centred and modulus > 2**15:  # read as signed
        wrapped = np.where(wrapped >= 0.5 * modulus, wrapped - modulus, wrapped)
    said: list[str] = []
    found = ordered("log", wrapped, 1e-3, said)
    np.testing.assert_allclose(np.diff(found.stamps), PERIOD, rtol=1e-6)
    assert list(found.begins) == [0]
    told = ["log: the clock wrapped once and is continued."]
    assert said == (told if (np.diff(wrapped) < 0).any() else [])


@given(st.lists(st.integers(30, 200), min_size=2, max_size=5), st.floats(2e3, 1e6))
def test_a_clock_that_starts_again_is_cut_there(lengths, start):
    stamps = np.concatenate([clock(n, start) for n in lengths])
    said: list[str] = []
    found = ordered("log", stamps, 1e-3, said)
    assert list(found.begins) == [0, *np.cumsum(lengths)[:-1]]
    np.testing.assert_array_equal(found.rows, np.arange(len(stamps)))
    assert f"first in row {lengths[0] + 1}" in said[0]


@given(st.integers(20, 370), st.integers(1, 4))
def test_rows_that_overtook_others_are_put_back(at, by):
    way = np.arange(400)
    way[at : at + by + 1] = np.roll(way[at : at + by + 1], 1)
    said: list[str] = []
    found = ordered("log", clock()[way], 1e-3, said)
    np.testing.assert_array_equal(found.stamps, clock())
    np.testing.assert_array_equal(way[found.rows], np.arange(400))
    assert "out of place put in order" in said[0]


@given(
    st.lists(st.integers(20, 370), min_size=1, max_size=5, unique=True),
    st.sampled_from([0.0, -1e9, 1e15, 1e300, np.nan, np.inf]),
)
def test_a_stamp_that_belongs_nowhere_is_dropped(rows, stamp):
    stamps = clock()
    stamps[rows] = stamp
    found = ordered("log", stamps, 1e-3, [])
    assert set(range(400)) - set(found.rows.tolist()) == set(rows)


@given(st.integers(1, 5), st.booleans(), st.sampled_from([0.0, -1e9, 1e15]), st.booleans())
def test_a_few_stamps_far_off_at_an_end_are_dropped(count, first, stamp, again):
    """A clock that was not set yet, or a counter that broke off, beside a restart or none."""
    assume(not again or first)
    true = clock(start=1e12 if stamp == 0.0 else 0.0)
    stamps = true.copy()
    rows = np.arange(count) if first else 400 - count + np.arange(count)
    stamps[rows] = stamp
    if again:
        stamps = np.concatenate([stamps, true])
    said: list[str] = []
    found = ordered("log", stamps, 1e-3, said)
    assert set(range(len(stamps))) - set(found.rows.tolist()) == set(rows)
    assert f"log: {count} rows whose time does not follow from those beside were dropped." in said


@pytest.mark.parametrize(
    ("stamps", "sentence"),
    [
        (np.sin(clock()), "time runs backwards in"),
        (clock()[::-1], "time runs backwards in 399 of 400 rows, first in row 2"),
        (np.full(9, np.nan), "fewer than two rows have a time"),
        (np.zeros(0), "fewer than two rows have a time"),
    ],
)
def test_what_is_no_time_is_refused(stamps, sentence):
    with pytest.raises(DataError, match=sentence):
        ordered("log", stamps, 1.0, [])


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


@pytest.mark.parametrize("jump", [1e3, 1e6, 1e9])
def test_a_clock_that_is_set_in_the_middle_goes_on_as_before(jump):
    """By seconds to years: the rows on either side are as far apart as ever."""
    stamps = 5e-3 * np.arange(2000)
    stamps[1000:] += jump
    found = even_clock(stamps)
    assert found.even is None
    assert found.period == pytest.approx(5e-3, rel=1e-6)
    assert found.shared == 1.0


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


def test_where_two_lines_meet_rows_stay_as_far_apart_as_their_stamps_up_to_half_a_period():
    late = 0.3 * np.random.default_rng(0).random(1000)
    late[:500] += 2.0  # on a line that ends behind where the next one begins
    late[499:504] = 2.0, 1.7, 1.2, 0.7, 0.2
    found = even_clock(1e-2 * (np.arange(1000) + late))
    assert found.even is not None
    steps = np.diff(found.even)[490:510] / found.period
    assert steps.min() == pytest.approx(0.5, abs=0.01)
