"""What holds for the tables of all readers: names that print, short names, one length, a bound."""

from collections import Counter
from collections.abc import Iterable
from typing import Any

import numpy as np

from spirob.errors import DataError
from spirob.logs.readers.columns.table import Asked, Table, printable

LARGEST = 2**28  # bytes of all columns
LIGHT = 2**26  # bytes beyond which only what is wanted is kept
LISTED = 5  # columns that a sentence names


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
        for known in (table.columns, table.text, table.units) if len(whole) == 1 else ():
            _alias(known, name, whole[0])


def _alias(known: dict[str, Any], name: str, whole: str) -> None:
    if whole in known:
        known[name] = known[whole]


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
