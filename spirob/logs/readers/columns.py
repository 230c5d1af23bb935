"""What all readers share: columns of a table.

`Asked` is what a reader is asked, `Table` what it gives: columns of numbers with names that print,
of one length, within a bound.  Arrays of any shape become columns, and columns of any kind numbers:
dates are seconds, texts that hold numbers those.
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from spirob.errors import DataError, MissingChannel

if TYPE_CHECKING:
    import pandas as pd

EXAMPLE = 40  # characters of a text that are shown


@dataclass(frozen=True)
class Asked:
    """What is to be read.

    wanted  names of the columns that will be used; empty means all
    dbc     what the frames of a CAN log mean
    """

    path: Path
    wanted: tuple[str, ...] = ()
    dbc: Path | None = None

    @property
    def name(self) -> str:
        """The file's name, as it can be printed."""
        return printable(self.path.name)


@dataclass
class Table:
    """A log as columns.

    name     file name, used in every sentence
    columns  name -> (n,) float, n the same for all
    said     sentences: what was not plain about the file
    units    unit of the columns of which the file itself knows it ("s" of dates, of log time);
             it stands above what a description says
    text     name -> an example of what a column holds that holds no numbers
    others   names of what the file holds besides, and that was not read
    """

    name: str
    columns: dict[str, np.ndarray] = field(default_factory=dict)
    said: list[str] = field(default_factory=list)
    units: dict[str, str] = field(default_factory=dict)
    text: dict[str, str] = field(default_factory=dict)
    others: list[str] = field(default_factory=list)

    def column(self, name: str) -> np.ndarray:
        """One column, (n,) float.

        Raises MissingChannel naming what is there, and DataError where the column holds text.
        """
        if name in self.columns:
            return self.columns[name]
        if name in self.text:
            raise DataError(
                f"{self.name}: column '{printable(name)}' holds {self.text[name]}, not numbers "
                "(times: in seconds, or as 2025-01-31 12:00:00.000)"
            )
        raise MissingChannel(self.name, printable(name), [*self.columns, *self.others])

    def say(self, sentence: str) -> None:
        """Add a sentence that begins with the file's name."""
        self.said.append(f"{self.name}: {sentence}")


def printable(name: str) -> str:
    """A name of any bytes as text that every encoding can print."""
    return name.encode("utf-8", "replace").decode("utf-8")


def example(value: object) -> str:
    """A text of a file, cut and in quotes."""
    said = " ".join(printable(str(value)[: 4 * EXAMPLE]).split())
    return f"'{said[:EXAMPLE]}…'" if len(said) > EXAMPLE else f"'{said}'"


MOST = 1000  # columns that one matrix may become


def spread(
    name: str, array: np.ndarray, label: str = "[{}]", first: int = 0
) -> Iterator[tuple[str, np.ndarray]]:
    """Columns (n,) of a vector, a matrix or an array with named fields; none of a single value.

    label, first  how a matrix counts its columns: `name[0]`, or MATLAB's `name(1)`
    The longer side of a matrix is time.  Of more dimensions those of one element do not count.
    """
    if array.ndim > 2:
        array = array.squeeze()
    if array.dtype.names:
        for field in array.dtype.names:
            yield from spread(f"{name}.{field}" if name else field, array[field], label, first)
    elif array.ndim == 1 and array.size > 1:
        yield name, array
    elif array.ndim == 2 and array.size > 1:
        rows = array if array.shape[0] >= array.shape[1] else array.T
        if rows.shape[1] == 1:
            yield name, rows[:, 0]
            return
        for k in range(min(rows.shape[1], MOST)):
            yield name + label.format(k + first), rows[:, k]


def tell_twice(table: Table, names: Iterable[str]) -> None:
    """Say of which name there are several columns, of which the first is used."""
    for name, count in sorted(Counter(names).items()):
        if name and count > 1:
            table.say(f"{count} columns are called '{name}'; the first is used.")


LARGEST = 2**28  # bytes of all columns
LIGHT = 2**26  # bytes beyond which only what is wanted is kept
LISTED = 5  # columns that a sentence names


def require_room(rows: int, columns: int) -> None:
    """Raise ValueError where a table would be larger than `LARGEST`, before it is filled.

    A few bytes of text may stand for a row of any width: what a short row lacks is filled up.
    """
    if 8 * rows * columns > LARGEST:
        raise ValueError(
            f"{rows} rows of {columns} columns are more than {LARGEST >> 20} MiB of numbers"
        )


def finished(table: Table, asked: Asked) -> Table:
    """A reader's table as it is given out; raises DataError where there is none."""
    _printable(table)
    _short_names(table, asked.wanted)
    _one_length(table, asked.wanted)
    if asked.wanted and _size(table) > LIGHT:
        table.others += [name for name in table.columns if name not in asked.wanted]
        table.columns = {n: v for n, v in table.columns.items() if n in asked.wanted}
    if _size(table) > LARGEST:
        raise DataError(f"{table.name}: it holds more than {LARGEST >> 20} MiB of numbers")
    if not (table.columns or table.text or table.others):
        raise DataError(f"{table.name}: holds no column of numbers")
    return table


def _printable(table: Table) -> None:
    table.columns = {printable(name): values for name, values in table.columns.items()}
    table.text = {printable(name): text for name, text in table.text.items()}
    table.units = {printable(name): unit for name, unit in table.units.items()}
    table.said = [printable(sentence) for sentence in table.said]
    table.others = [printable(name) for name in table.others]


def _short_names(table: Table, wanted: Iterable[str]) -> None:
    """`q` stands for `data.q` where only one column ends so."""
    for name in wanted:
        if name in table.columns or name in table.text:
            continue
        whole = [n for n in (*table.columns, *table.text) if n.endswith(f".{name}")]
        for known in (table.columns, table.text, table.units):
            if len(whole) == 1 and whole[0] in known:
                known[name] = known[whole[0]]  # type: ignore[assignment]


def _one_length(table: Table, wanted: Iterable[str]) -> None:
    lengths = {name: len(values) for name, values in table.columns.items()}
    if len(set(lengths.values())) < 2:
        return
    asked = {name: lengths[name] for name in wanted if name in lengths}
    if len(set(asked.values())) > 1:
        told = ", ".join(f"'{name}' has {rows} rows" for name, rows in asked.items())
        raise DataError(f"{table.name}: {told}; columns of one log have one length")
    usual = next(iter(asked.values()), 0) or max(Counter(lengths.values()).items(), key=_most)[0]
    left = [name for name, rows in lengths.items() if rows != usual]
    told = ", ".join(f"'{name}' ({lengths[name]})" for name in left[:LISTED])
    more = f" and {len(left) - LISTED} more" if len(left) > LISTED else ""
    table.say(f"columns of another length than {usual} rows are left out: {told}{more}.")
    for name in left:
        del table.columns[name]
        table.units.pop(name, None)


def _most(counted: tuple[int, int]) -> tuple[int, int]:
    rows, columns = counted
    return columns, rows


def _size(table: Table) -> int:
    distinct: dict[int, np.ndarray] = {id(values): values for values in table.columns.values()}
    return sum(values.nbytes for values in distinct.values())


DATE = r"\d{4}-?\d\d-?\d\d"
CLOCK = r"\d\d?:\d\d:\d\d(?:[.,]\d+)?"
ZONE = r"\s?(?:Z|[+-]\d\d:?(?:\d\d)?)?"
STAMP = re.compile(  # ISO 8601, or a time of day; a bare 20231114 is a number
    rf"\s*(?:\d{{4}}-\d\d-\d\d|{CLOCK}|"
    rf"{DATE}[T ](?:{CLOCK}|\d\d:\d\d|\d{{4,6}}(?:[.,]\d+)?){ZONE})\s*"
)
OF_DAY = re.compile(CLOCK)
TIMES = 0.9  # of the cells must be times, where a column is to be one of times
DAY = 86400.0  # s


def add(table: Table, name: str, values: "np.ndarray | pd.Series") -> None:
    """Put a column, (n,) of any kind, where it belongs in a table."""
    import pandas as pd

    kind = values.dtype.kind if isinstance(values.dtype, np.dtype) else "O"
    if kind in "fiub":
        table.columns[name] = np.asarray(values, float)
    elif kind == "M":
        _add_times(table, name, np.asarray(values))
    elif kind == "m":
        _add_seconds(table, name, np.asarray(values))
    elif kind in "SUO":
        cells = pd.Series(values, dtype=object).map(_plain)  # which tells what objects are
        if isinstance(cells.dtype, pd.DatetimeTZDtype):
            cells = cells.dt.tz_convert(None)
        if cells.dtype.kind == "O":
            _add_text(table, name, cells)
        else:
            add(table, name, cells.to_numpy())
    else:
        table.text[name] = f"values such as {example(np.asarray(values).flat[0])}"


def _plain(cell: object) -> object:
    """A cell as text that can be printed, where it is text."""
    if isinstance(cell, bytes):
        return cell.decode("utf-8", "replace")
    return printable(cell) if isinstance(cell, str) else cell


def _add_text(table: Table, name: str, cells: "pd.Series") -> None:
    import pandas as pd

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
    enough = TIMES * len(filled)
    if texts.str.fullmatch(STAMP).sum() < enough:
        table.text[name] = f"text such as {example(filled.iloc[0])}"
    elif texts.str.fullmatch(OF_DAY).sum() >= enough:
        _add_hours(table, name, pd.to_timedelta(texts.reindex(cells.index), errors="coerce"))
    else:
        times = _dates(texts)
        if times.isna().all():  # such as the month 13
            table.text[name] = f"text such as {example(filled.iloc[0])}"
        else:
            _add_times(table, name, times.reindex(cells.index).to_numpy())


def _dates(texts: "pd.Series") -> "pd.Series":
    """Instants of ISO 8601; to a microsecond where a year lies beyond what counts nanoseconds."""
    import pandas as pd

    def instants(cells: "pd.Series") -> "pd.Series":
        read = pd.to_datetime(cells, format="ISO8601", utc=True, errors="coerce")
        return read.dt.tz_localize(None)

    times = instants(texts)
    if times.isna().all():
        times = instants(texts.str.replace(r"(\.\d{6})\d+", r"\1", regex=True))
    return times


def _add_times(table: Table, name: str, times: np.ndarray) -> None:
    """Instants, (n,) datetime64, as seconds since the first, as exact as they are."""
    known = times[~np.isnat(times)]
    first = known[0] if len(known) else np.datetime64(0, "s")
    _add_seconds(table, name, times - first)
    since = str(first)[: len("2025-01-01T00:00:00.000")]
    table.say(f"'{name}' holds dates; they are seconds since {since} (UTC).")


def _add_hours(table: Table, name: str, times: "pd.Series") -> None:
    """Times of day, (n,) timedelta, as seconds since the first; midnight may pass."""
    seconds = times.dt.total_seconds().to_numpy(float, copy=True)
    known = np.flatnonzero(np.isfinite(seconds))
    passed = np.cumsum(np.diff(seconds[known], prepend=seconds[known[:1]]) < -DAY / 2)
    seconds[known] += DAY * passed - seconds[known[0]]
    table.columns[name], table.units[name] = seconds, "s"
    since = str(times.iloc[known[0]]).removeprefix("0 days ")
    table.say(f"'{name}' holds times of day; they are seconds since {since}.")


def _add_seconds(table: Table, name: str, spans: np.ndarray) -> None:
    table.columns[name] = spans / np.timedelta64(1, "s")
    table.units[name] = "s"


def from_frame(frame: "pd.DataFrame", name: str) -> Table:
    """The columns of a frame, and its index where that has a name, as a table."""
    table = Table(printable(name))
    whole = frame.reset_index() if frame.index.name is not None else frame
    for k, column in enumerate(whole.columns):
        if str(column) not in table.columns:
            add(table, str(column), whole.iloc[:, k].to_numpy())
    tell_twice(table, map(str, whole.columns))
    return table
