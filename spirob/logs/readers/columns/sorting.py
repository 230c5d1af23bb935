"""Columns of any kind to numbers, and a table of pandas as a log."""

import re

import numpy as np
import pandas as pd

from spirob.logs.readers.columns.table import Table, example, printable

DATE = r"\d{4}-?\d\d-?\d\d"
CLOCK = r"\d\d?:\d\d:\d\d(?:[.,]\d+)?"
ZONE = r"\s?(?:Z|[+-]\d\d:?(?:\d\d)?)?"
STAMP = re.compile(  # ISO 8601, or a time of day; a bare 20231114 is a number
    rf"\s*(?:\d{{4}}-\d\d-\d\d|{CLOCK}|"
    rf"{DATE}[T ](?:{CLOCK}|\d\d:\d\d|\d{{4,6}}(?:[.,]\d+)?){ZONE})\s*"
)
OF_DAY = re.compile(CLOCK)
MOST = 0.9  # of the cells must be times, where a column is to be one of times
DAY = 86400.0  # s


def add(table: Table, name: str, values: np.ndarray | pd.Series) -> None:
    """Put a column, (n,) of any kind, where it belongs in a table."""
    kind = values.dtype.kind if isinstance(values.dtype, np.dtype) else "O"
    if kind in "fiub":
        table.columns[name] = np.asarray(values, float)
    elif kind == "M":
        _add_times(table, name, np.asarray(values).astype("datetime64[ns]"))
    elif kind == "m":
        _add_seconds(table, name, np.asarray(values).astype("timedelta64[ns]"))
    elif kind in "SUO":
        _add_text(table, name, pd.Series(values, dtype=object).map(_plain))
    else:
        table.text[name] = f"values such as {example(np.asarray(values).flat[0])}"


def _plain(cell: object) -> object:
    """A cell as text that can be printed, where it is text."""
    if isinstance(cell, bytes):
        return cell.decode("utf-8", "replace")
    return printable(cell) if isinstance(cell, str) else cell


def _add_text(table: Table, name: str, cells: pd.Series) -> None:
    filled = cells.dropna()
    texts = filled[filled.map(lambda cell: isinstance(cell, str))].str.strip()
    filled = filled.drop(texts.index[texts == ""])
    try:
        numbers = pd.to_numeric(cells, errors="coerce").to_numpy(float)
    except (TypeError, ValueError, OverflowError):
        numbers = np.full(len(cells), np.nan)
    if 2 * np.count_nonzero(~np.isnan(numbers)) >= len(filled):
        table.columns[name] = numbers
        return
    texts = texts.str.replace(",", ".")
    enough = MOST * len(filled)
    if texts.str.fullmatch(STAMP).sum() < enough:
        table.text[name] = f"text such as {example(filled.iloc[0])}"
    elif texts.str.fullmatch(OF_DAY).sum() >= enough:
        _add_hours(table, name, pd.to_timedelta(texts.reindex(cells.index), errors="coerce"))
    else:
        times = pd.to_datetime(texts, format="ISO8601", utc=True, errors="coerce")
        known = times.dt.tz_localize(None).reindex(cells.index)
        _add_times(table, name, known.to_numpy("datetime64[ns]"))


def _add_times(table: Table, name: str, times: np.ndarray) -> None:
    """Instants, (n,) datetime64[ns], as seconds since the first; exact to a nanosecond."""
    known = times[~np.isnat(times)]
    first = known[0] if len(known) else np.datetime64(0, "ns")
    _add_seconds(table, name, times - first)
    since = np.datetime_as_string(first, "ms")
    table.say(f"'{name}' holds dates; they are seconds since {since} (UTC).")


def _add_hours(table: Table, name: str, times: pd.Series) -> None:
    """Times of day, (n,) timedelta, as seconds since the first; midnight may pass."""
    seconds = times.dt.total_seconds().to_numpy(float, copy=True)
    known = np.flatnonzero(np.isfinite(seconds))
    passed = np.cumsum(np.diff(seconds[known], prepend=seconds[known[:1]]) < -DAY / 2)
    seconds[known] += DAY * passed - seconds[known[0]]
    table.columns[name], table.units[name] = seconds, "s"
    table.say(f"'{name}' holds times of day; they are seconds since {times.iloc[known[0]]}.")


def _add_seconds(table: Table, name: str, spans: np.ndarray) -> None:
    seconds = spans.astype("timedelta64[ns]").astype(np.int64) / 1e9
    table.columns[name] = np.where(np.isnat(spans), np.nan, seconds)
    table.units[name] = "s"


def from_frame(frame: pd.DataFrame, name: str) -> Table:
    """The columns of a frame, and its index where that has a name, as a table."""
    table = Table(printable(name))
    whole = frame.reset_index() if frame.index.name is not None else frame
    for k, column in enumerate(whole.columns):
        if str(column) not in table.columns:
            add(table, str(column), whole.iloc[:, k].to_numpy())
    return table
