"""JSON: columns `{"q": [...]}`, rows `[{"q": ...}, ...]`, both also within `{"data": ...}`.

Rows may also stand one to a line.
"""

import json
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np

from spirob.errors import DataError
from spirob.logs.readers.columns import Asked, Table, printable, require_room, spread

KIND = "JSON file"
SUFFIXES = {".json", ".jsonl", ".ndjson"}
PLAIN = True

LARGEST = 2**27  # bytes of text
DEEPEST = 8  # structures within structures
COLUMNS = 5000
DIGITS = 18


def read(asked: Asked) -> Table:
    """Columns named by their place, `pose.x`, `position[0]`; what stands around all is left out.

    Raises DataError where it is no JSON or holds no table.
    """
    from spirob.logs.readers.columns import add

    where, table = printable(str(asked.path)), Table(asked.name)
    if asked.path.stat().st_size > LARGEST:
        raise DataError(f"{where}: more than {LARGEST >> 20} MiB of text; use Parquet")
    columns: dict[str, list[Any]] = {}
    cells = 0
    for name, values in _columns("", _content(asked, table), 0):
        columns[name] = values
        cells += len(values)
        _require_table(-(-cells // len(columns)), len(columns))
    for name, values in columns.items():
        add(table, name, _array(values))
    _without_shell(table)
    return table


def _require_table(rows: int, columns: int) -> None:
    if columns > COLUMNS:
        raise ValueError(f"more than {COLUMNS} columns are no table")
    require_room(rows, columns)


def _content(asked: Asked, table: Table) -> Any:
    content = asked.path.read_bytes()
    try:
        return _loaded(content)
    except json.JSONDecodeError as error:
        lines = [line for line in content.splitlines() if line.strip()]
        by_lines = asked.path.suffix.lower() != ".json" or error.msg.startswith("Extra data")
        if not (by_lines and lines):
            raise
    try:
        rows = [_loaded(line) for line in lines[:-1]]
    except json.JSONDecodeError as error:
        raise ValueError(f"neither one document nor one for each line: {error}") from None
    try:
        rows.append(_loaded(lines[-1]))
    except json.JSONDecodeError:
        table.say("the last line breaks off and is left out.")
    return rows


def _loaded(text: bytes) -> Any:
    try:
        return json.loads(text, object_pairs_hook=_once, parse_int=_whole)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def _whole(digits: str) -> int | float:
    """A whole number; one that no 64 bits hold as a float, infinite where that holds it not."""
    return int(digits) if len(digits) <= DIGITS else float(digits)


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        [(twice, _)] = Counter(name for name, _ in pairs).most_common(1)
        raise ValueError(f"'{printable(twice)[:40]}' stands twice in one object")
    return found


def _columns(name: str, value: Any, depth: int) -> Iterator[tuple[str, list[Any]]]:
    """All columns at and below a place of the document."""
    if depth > DEEPEST:
        return
    if isinstance(value, dict):
        named = value.get("columns")
        if isinstance(named, list) and isinstance(value.get("data"), list):  # pandas' "split"
            value = [_row(named, row) for row in value["data"]]
        elif len(value) > 1 and all(key.isdecimal() for key in value):  # counted, not named
            value = list(value.values())
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _columns(f"{name}.{key}" if name else key, inner, depth + 1)
    elif isinstance(value, list) and len(value) > 1:
        if any(isinstance(item, dict | list) for item in value):
            yield from _rows(name, value)
        else:
            yield name, value


def _row(names: list[Any], row: Any) -> dict[str, Any]:
    cells = row if isinstance(row, list) else [row]
    return dict(zip(map(str, names), cells, strict=False))


def _rows(name: str, rows: list[Any]) -> Iterator[tuple[str, list[Any]]]:
    if any(isinstance(row, list) for row in rows):
        sizes = {len(row) if isinstance(row, list) else -1 for row in rows}
        cells = (cell for row in rows if isinstance(row, list) for cell in row)
        scalar = not any(isinstance(cell, dict | list) for cell in cells)
        if len(sizes) == 1 and min(sizes) > 0 and scalar:
            for label, values in spread(name or "column", np.array(rows, object)):
                yield label, list(values)
        return
    found: dict[str, list[Any]] = {}
    for k, row in enumerate(rows):
        for key, cell in _cells("", row, 0):
            if key not in found:
                found[key] = []
                _require_table(len(rows), len(found))
            column = found[key]
            column.extend([None] * (k - len(column)))
            column.append(cell)
    for key, column in found.items():
        column.extend([None] * (len(rows) - len(column)))
        yield f"{name}.{key}" if name else key, column


def _cells(name: str, value: Any, depth: int) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict) and depth <= DEEPEST:
        for key, inner in value.items():
            yield from _cells(f"{name}.{key}" if name else key, inner, depth + 1)
    elif isinstance(value, list) and depth <= DEEPEST:
        for k, inner in enumerate(value):
            yield from _cells(f"{name}[{k}]", inner, depth + 1)
    elif name:
        yield name, value


def _array(values: list[Any]) -> np.ndarray:
    if all(value is None or isinstance(value, int | float) for value in values):
        try:
            return np.array([np.nan if value is None else value for value in values], float)
        except OverflowError:
            pass
    array = np.empty(len(values), object)
    array[:] = values
    return array


def _without_shell(table: Table) -> None:
    """Leave out what all names begin with: `data.q` is `q`."""
    names = [*table.columns, *table.text]
    while names and all("." in n for n in names) and len({n.partition(".")[0] for n in names}) == 1:
        for kept in (table.columns, table.text, table.units):
            inner = {name.partition(".")[2]: value for name, value in kept.items()}
            kept.clear()
            kept.update(inner)  # type: ignore[arg-type]
        names = [name.partition(".")[2] for name in names]
