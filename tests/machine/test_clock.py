"""Late stamps get an even clock, uneven rows keep theirs: the motion says which of them it is."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spirob.errors import DataError, NothingLeft, TooShort
from spirob.machine.recordings.clock import clock_of

RATE = 200.0


def moved(seconds):
    return {"q": np.sin(2.0 * seconds) + 0.2 * np.cos(9.0 * seconds)}


@pytest.mark.parametrize("scatter", [0.3, 0.6, 0.9])
def test_uneven_rows_with_rests_and_much_noise_keep_their_stamps(scatter):
    rng = np.random.default_rng(3)
    steps = rng.gamma(scatter**-2, scatter**2, 4000) / RATE
    seconds = np.cumsum(np.maximum(steps, 1e-3 / RATE))
    rests = np.sin(0.5 * seconds) < 0.4
    q = np.where(rests, 0.1234567, 0.1234567 + np.sin(0.5 * seconds) - 0.4)
    said: list[str] = []
    clock_of("log", seconds, 1.0, {"q": q, "u": q + rng.normal(0.0, 0.3, 4000)}, said)
    assert "even grid" in said[0]


@given(st.floats(0.3, 1.0), st.integers(0, 2**32))
def test_late_stamps_and_uneven_rows_are_told_apart(size, seed):
    rng = np.random.default_rng(seed)
    even = np.arange(1500) / RATE
    late = np.maximum.accumulate(even + size * rng.random(1500) / RATE)
    said: list[str] = []
    found = clock_of("log", late, 1.0, moved(even), said)
    np.testing.assert_allclose(np.diff(found.seconds), 1 / RATE, rtol=1e-3)
    assert "smoother on an even clock" in said[0]
    said = []
    found = clock_of("log", late, 1.0, moved(late), said)
    np.testing.assert_allclose(found.seconds, late - late[0], atol=1e-2 / RATE)
    assert "put on an even grid" in said[0]


@pytest.mark.parametrize("jitter", [0.25, 0.4])
def test_stamps_that_cross_by_jitter_do_not_exchange_rows(jitter):
    rng = np.random.default_rng(9)
    even = np.arange(3000) / RATE
    stamps = even + jitter * rng.standard_normal(3000) / RATE
    assert np.any(np.diff(stamps) < 0)
    motion = moved(even)["q"] + 2e-5 * rng.standard_normal(3000)
    said: list[str] = []
    found = clock_of("log", stamps, 1.0, {"q": motion, "u": np.sin(3.0 * even)}, said)
    np.testing.assert_array_equal(found.rows, np.arange(3000))
    np.testing.assert_allclose(np.diff(found.seconds), 1 / RATE, rtol=1e-3)
    assert "smoother as logged, and stay so" in said[-1]


def test_rows_that_were_logged_in_another_order_are_put_in_order_of_late_stamps():
    rng = np.random.default_rng(4)
    even = np.arange(3000) / RATE
    stamps = even + 0.9 * rng.random(3000) / RATE
    order = np.arange(3000)
    order[100::400], order[101::400] = order[101::400], order[100::400].copy()
    signals = {"q": moved(even)["q"][order]}
    said: list[str] = []
    found = clock_of("log", stamps[order], 1.0, signals, said)
    np.testing.assert_array_equal(order[found.rows], np.arange(3000))
    assert not any("as logged" in sentence for sentence in said)


@given(st.integers(2, 30), st.floats(0.0, 1e9))
def test_a_coarse_clock_is_spread_and_said(rows, origin):
    even = np.arange(1500) / RATE
    said: list[str] = []
    stamps = origin + np.arange(1500) // rows * rows / RATE
    found = clock_of("log", stamps, 1.0, moved(even), said)
    off = found.seconds - even  # a common delay tells nothing
    np.testing.assert_allclose(off, np.median(off), atol=0.5 / RATE)
    assert f"coarser than the samples, {rows} rows to a stamp" in said[0]


@given(st.integers(2, 30), st.integers(0, 2**32))
def test_a_row_whose_stamp_is_broken_keeps_its_place(rows, seed):
    even, rng = np.arange(1500) / RATE, np.random.default_rng(seed)
    stamps = np.arange(1500) // rows * rows / RATE
    stamps[rng.integers(rows + 1, 1500 - rows, 8)] = rng.choice([np.nan, 1e12, -5.0], 8)
    found = clock_of("log", stamps, 1.0, moved(even), [])
    off = found.seconds - even[found.rows]
    np.testing.assert_allclose(off, np.median(off), atol=0.1 / RATE)


@pytest.mark.parametrize("unit", [1.0, 1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("origin", [0.0, -3.0, 1.7e9])
def test_any_unit_and_origin(unit, origin):
    even = np.arange(1500) / RATE
    said: list[str] = []
    found = clock_of("log", (origin + even) / unit, unit, moved(even), said)
    np.testing.assert_allclose(found.seconds, even, atol=1e-6)
    assert found.period == pytest.approx(1 / RATE, rel=1e-6)
    assert said == []


def test_rows_that_are_logged_twice_are_dropped():
    even = np.arange(1500) / RATE
    said: list[str] = []
    twice = {"q": np.repeat(moved(even)["q"], 2)}
    found = clock_of("log", np.repeat(even, 2), 1.0, twice, said)
    np.testing.assert_allclose(found.seconds, even)
    assert "1500 rows that repeat the one before were dropped" in said[0]


def test_rows_that_are_logged_twice_by_a_coarse_clock_are_dropped():
    even = np.arange(1500) / RATE
    said: list[str] = []
    stamps = np.arange(1500) // 4 * 4 / RATE
    clock_of("log", np.repeat(stamps, 2), 1.0, {"q": np.repeat(moved(even)["q"], 2)}, said)
    assert "1500 rows that repeat the one before were dropped" in said[0]


def test_an_axis_that_stands_repeats_nothing():
    even = np.arange(1500) / RATE
    still = moved(np.where(np.sin(even) > 0, even, 0.0))
    said: list[str] = []
    clock_of("log", np.arange(1500) // 4 * 4 / RATE, 1.0, still, said)
    assert not any("repeat" in text for text in said)


def test_each_start_of_the_clock_begins_a_stretch():
    even = np.arange(1500) / RATE
    again = np.concatenate([even[:700], even[:500], even[:300]])
    found = clock_of("log", again, 1.0, moved(even), [])
    assert list(found.begins) == [700, 1200]
    assert np.all(np.diff(found.seconds)[[699, 1199]] > found.longest)


@pytest.mark.parametrize(
    ("stamps", "error", "sentence"),
    [
        (np.arange(30) / RATE, TooShort, "30 samples"),
        (np.arange(99) / RATE, NothingLeft, r"0\.495 s long"),
        (np.zeros(100), NothingLeft, "0 s long"),
        (np.arange(100.0), DataError, "1 samples a second.*is the unit of time right"),
        (1e300 * np.arange(100.0), DataError, "is the unit of time right"),
        (9e-7 * np.arange(5.6e5), DataError, r"1\.11e\+06 samples a second"),
    ],
)
def test_no_usable_clock_is_one_sentence(stamps, error, sentence):
    with pytest.raises(error, match=sentence):
        clock_of("log", stamps, 1.0, {"q": np.arange(len(stamps))}, [])


def test_the_last_row_lasts_as_long_as_the_others():
    stamps = np.arange(100) / RATE  # half a second, though 0.495 s lie between first and last
    assert len(clock_of("log", stamps, 1.0, moved(stamps), []).seconds) == 100
