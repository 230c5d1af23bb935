"""Dates of any year are told as they stand; what is none is text."""

import numpy as np
import pandas as pd
import pytest

from spirob.errors import DataError
from spirob.logs.readers.columns import from_frame

STEP = 0.005  # s
YEARS = ["0001", "1500", "2025", "2262", "2263", "9999"]


def stamps(year):
    """Forty instants of the last minute of a year."""
    first = np.datetime64(f"{year}-12-31T23:59:30.000", "ms")
    return first + np.arange(40) * np.timedelta64(5, "ms")


@pytest.mark.parametrize("year", YEARS)
@pytest.mark.parametrize("kind", ["ms", "us", "text", "text to a nanosecond"])
def test_every_year_is_told_as_it_stands(year, kind):
    made = stamps(year)
    if kind.startswith("text"):
        made = [f"{stamp}{'000123' if kind != 'text' else ''}Z" for stamp in made]
    else:
        made = made.astype(f"datetime64[{kind}]")
    table = from_frame(pd.DataFrame({"t": made}), "a")
    np.testing.assert_allclose(table.column("t"), STEP * np.arange(40), atol=1e-9)
    assert table.units == {"t": "s"}
    said = f"a: 't' holds dates; they are seconds since {year}-12-31T23:59:30.000 (UTC)."
    assert table.said == [said]


def test_a_span_beyond_three_centuries_is_as_long_as_it_is():
    table = from_frame(pd.DataFrame({"t": np.array([0, 10**11], "timedelta64[s]")}), "a")
    np.testing.assert_array_equal(table.column("t"), [0.0, 1e11])


@pytest.mark.parametrize("stamp", ["2025-13-01T00:00:00", "2016-12-31T23:59:60"])
def test_what_no_calendar_holds_is_text(stamp):
    table = from_frame(pd.DataFrame({"t": [stamp] * 5, "q": np.arange(5.0)}), "a")
    with pytest.raises(DataError, match=rf"'t'.* text such as '{stamp}'"):
        table.column("t")


def test_a_time_of_day_is_told_as_it_stands():
    stamps = [f"23:59:5{k}" for k in range(5)]
    table = from_frame(pd.DataFrame({"t": stamps, "q": np.arange(5.0)}), "a")
    assert table.said == ["a: 't' holds times of day; they are seconds since 23:59:50."]
