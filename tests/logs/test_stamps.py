"""Stamps come in order, whatever the counter and the way of the rows, or are refused."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spirob.errors import DataError
from spirob.logs.stamps import ordered

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
