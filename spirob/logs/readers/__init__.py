"""Logs as tables, whatever they are kept as: `read_table`.

One file for each kind of log; a new file here is a new kind, no list names it:

    KIND           what its sentences call it: "Parquet file"
    SUFFIXES       of the names of such files, in lower case
    read(asked)    an `Asked` as a `Table`; `columns.add` puts a column into it
    BEGINS         pattern of the first bytes of such a file, where its name may not tell; optional
    FOLDER         a folder with a file that matches this pattern is such a log; optional
    NEEDS          libraries that are loaded only once for many files; optional
    PLAIN          such a file, where it is small, is read without a process of its own; optional

columns.py    what all of them share: the table, and any column or array to numbers
topics.py     what logs of messages share: fields, one time for several topics
decoders.py   bytes to messages: JSON, protobuf, ROS
isolation.py  a process of its own, with bounded time and memory
"""

import importlib
import pkgutil
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from types import ModuleType

from spirob.errors import DataError, MissingLog
from spirob.logs.readers.columns import Asked, Table, finished, printable
from spirob.logs.readers.isolation import apart

SMALL = 2**22  # bytes of a plain file that is read here
HEAD = 512  # bytes in which a file shows its kind
__all__ = ["Table", "read_table"]


def read_table(
    path: Path | str, wanted: Sequence[str] = (), dbc: Path | str | None = None
) -> Table:
    """A log of any known kind as a table.

    wanted  names of the columns that will be used; a log of many may hold back the others
    dbc     the DBC file that says what the frames of a CAN log mean
    Raises MissingLog where there is no file, DataError where it cannot be read.  Columns that are
    missing are told when they are taken, by `Table.column`.
    """
    where = printable(str(path))
    if "\0" in str(path):
        raise DataError(f"{where.replace(chr(0), '?')}: a name of a file holds no zero byte")
    asked = Asked(Path(path), tuple(wanted), None if dbc is None else Path(dbc))
    try:
        kind = _kind(asked.path, where)
        plain = getattr(kind, "PLAIN", False) and asked.path.stat().st_size <= SMALL
    except OSError as error:
        raise DataError(f"{where}: cannot be read: {error.strerror}") from None
    try:
        if plain:
            return _read(kind.__name__, asked)
        return apart(_read, kind.__name__, asked, needs=getattr(kind, "NEEDS", ()))
    except (ValueError, RecursionError) as error:
        said = printable(" ".join(str(error).split())[:300])
        raise DataError(f"{where}: this is no readable {kind.KIND}: {said}") from None


def _read(kind: str, asked: Asked) -> Table:
    table: Table = importlib.import_module(kind).read(asked)
    return finished(table, asked)


@cache
def kinds() -> tuple[ModuleType, ...]:
    """The readers, in the order of their names; they load their libraries when they read."""
    found = [i.name for i in pkgutil.iter_modules(__path__, f"{__name__}.") if not i.ispkg]
    modules = [importlib.import_module(name) for name in found]
    return tuple(module for module in modules if hasattr(module, "SUFFIXES"))


def _kind(path: Path, where: str) -> ModuleType:
    if path.is_dir():
        for kind in kinds():
            if hasattr(kind, "FOLDER") and any(kind.FOLDER.search(p.name) for p in path.iterdir()):
                return kind
        raise DataError(f"{where}: is a folder, and none that holds a ROS 2 bag")
    if path.exists() and not path.is_file():
        raise DataError(f"{where}: is a pipe or a device, no log")
    if not path.is_file():
        raise MissingLog(f"{where}: there is no such log")
    with path.open("rb") as file:
        head = file.read(HEAD)
    for kind in kinds():
        if hasattr(kind, "BEGINS") and kind.BEGINS.match(head):
            return kind
    for kind in kinds():
        if path.suffix.lower() in kind.SUFFIXES:
            return kind
    known = " ".join(sorted({suffix for kind in kinds() for suffix in kind.SUFFIXES}))
    raise DataError(f"{where}: '{printable(path.suffix)}' is no known kind of log; known: {known}")
