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
topics.py     what logs of messages share: one time for several topics
fields.py     the number at one place of a message
decoders.py   bytes to messages: JSON, protobuf, ROS

A reader runs in a process of its own (`apart`), with bounded time and memory.  Native code that a
damaged file brings down (a segmentation fault in `scipy.io.loadmat` is easily found by flipping
bytes) then takes down that process alone, and a length that a file only claims ends there as an
error.
"""

import importlib
import multiprocessing
import os
import pkgutil
import re
import shutil
import signal
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from multiprocessing import util
from multiprocessing.connection import Connection
from pathlib import Path
from types import ModuleType
from typing import Any

from spirob.ending import at_end
from spirob.errors import DataError, MissingLog, NothingLeft
from spirob.logs.readers.columns import Asked, Table, finished, printable

OBJECT = re.compile(r":? ?<[^<>]* object at 0x[0-9a-f]+>")  # as Python prints what has no text
SMALL = 2**22  # bytes of a plain file that is read here
HEAD = 512  # bytes in which a file shows its kind
ALWAYS = ("spirob.logs.readers", "pandas")  # loaded before the first process is forked
LONGEST = 60.0  # s
ENDING = 5.0  # s that a process has to be gone once it has closed its end
TIMED = -signal.SIGPROF if hasattr(signal, "SIGPROF") else None  # exit code, by its own timer
MEMORY = 2**30  # bytes of data, where the system can bound it
_STARTING = threading.Lock()
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
        said = printable(" ".join(OBJECT.sub("", str(error)).split())[:300])
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


class Crashed(ValueError):
    """The reader's process ended without an answer."""


class TooLong(Crashed):
    """It took longer than it may."""


def apart(
    function: Callable[..., Any],
    *arguments: Any,
    needs: Sequence[str] = (),
    longest: float = LONGEST,
) -> Any:
    """`function(*arguments)` of a module's top level, run apart with a gigabyte at most.

    needs    further modules to load before the first process is forked
    longest  s that it may take by the clock
    Raises the DataError that it raises, ValueError for any other, Crashed where its process dies,
    and TooLong where it takes longer, or ends by a timer of its own (`signal.ITIMER_PROF`).
    """
    with tempfile.TemporaryDirectory(prefix="spirob_", ignore_cleanup_errors=True) as place:
        return _apart(function, arguments, place, needs, longest)


def _apart(
    function: Callable[..., Any],
    arguments: tuple[Any, ...],
    place: str,
    needs: Sequence[str],
    longest: float,
) -> Any:
    """What `apart` says; `place` holds what the process leaves behind when it is ended."""
    context = _context()
    if context.get_start_method() == "forkserver":
        context.set_forkserver_preload([*ALWAYS, *needs])
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=_answer, args=(there, place, function, arguments), daemon=True)
    with _main_left_alone():
        process.start()
    there.close()
    try:
        if not here.poll(longest):
            raise TooLong(f"reading it takes longer than {longest:.0f} s")
        done, value = here.recv()
    except (EOFError, OSError):
        process.join(ENDING)
        if process.exitcode == TIMED:
            raise TooLong("reading it takes too long") from None
        raise Crashed("its content brings the reader down") from None
    finally:
        process.kill()
        process.join()
        here.close()
    if not done:
        raise value
    return value


@cache
def _context() -> Any:
    """How processes are started: each from one that has loaded what most need, where there is."""
    at_end(lambda: shutil.rmtree(util.get_temp_dir(), ignore_errors=True))  # its sockets
    methods = multiprocessing.get_all_start_methods()
    return multiprocessing.get_context("forkserver" if "forkserver" in methods else "spawn")


@contextmanager
def _main_left_alone() -> Iterator[None]:
    """The process that starts does not run a script of the user's again, as it else would."""
    with _STARTING:
        main = sys.modules["__main__"]
        sys.modules["__main__"] = ModuleType("__main__")
        try:
            yield
        finally:
            sys.modules["__main__"] = main


def _answer(
    there: Connection, place: str, function: Callable[..., Any], arguments: tuple[Any, ...]
) -> None:
    _bound()
    tempfile.tempdir = place
    own = os.getpid()

    def tell(done: bool, value: Any) -> None:
        if os.getpid() != own:  # a child that the function left behind
            os._exit(1)
        there.send((done, value))

    threading.Thread(target=_end_with_asker, daemon=True).start()
    try:
        tell(True, function(*arguments))
    except MemoryError:
        tell(False, ValueError(f"reading it takes more than {MEMORY >> 20} MiB"))
    except DataError as error:
        kind = NothingLeft if isinstance(error, NothingLeft) else DataError
        tell(False, kind(printable(str(error))))
    except BaseException as error:  # what runs here may raise what ends a process, too
        tell(False, ValueError(" ".join(str(error).split())[:200] or type(error).__name__))


def _end_with_asker() -> None:
    """End with the process that asked; the server that forked this one lives as long as this."""
    if asker := multiprocessing.parent_process():
        asker.join()
        os._exit(1)


def _bound() -> None:
    """No more memory than `MEMORY` for this process's data from now on."""
    try:
        import resource
    except ImportError:  # no such thing here; sizes are counted before anything is read
        return
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    bound = MEMORY if most == resource.RLIM_INFINITY else min(MEMORY, most)
    resource.setrlimit(resource.RLIMIT_DATA, (bound, most))
