"""Run a reader in a process of its own, with bounded memory.

Native code that a damaged file brings down (a segmentation fault in `scipy.io.loadmat` is easily
found by flipping bytes) then takes down that process alone, and a length that a file only claims
ends there as an error.
"""

import multiprocessing
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from types import ModuleType
from typing import Any

# imported once, before the first process is forked from that of the server
READERS = ("spirob.logs.foreign.mat", "spirob.logs.foreign.parquet")
LONGEST = 60.0  # s
MEMORY = 2**30  # bytes of data, where the system can bound it


class Crashed(ValueError):
    """The reader's process ended without an answer."""


def apart(function: Callable[..., Any], *arguments: Any) -> Any:
    """`function(*arguments)` of a module's top level, run apart with a gigabyte at most.

    Raises what it raises, and Crashed where its process dies or takes longer than a minute.
    """
    methods = multiprocessing.get_all_start_methods()
    context: Any = multiprocessing.get_context("forkserver" if "forkserver" in methods else "spawn")
    if "forkserver" in methods:
        context.set_forkserver_preload(list(READERS))
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=_answer, args=(there, function, arguments), daemon=True)
    with _without_main():
        process.start()
    there.close()
    try:
        if not here.poll(LONGEST):
            raise Crashed("reading it takes longer than a minute")
        done, value = here.recv()
    except (EOFError, OSError):
        raise Crashed("its content brings the reader down") from None
    finally:
        process.kill()
        process.join()
        here.close()
    if not done:
        raise value
    return value


@contextmanager
def _without_main() -> Iterator[None]:
    """Inside, a new process does not run the program's own file again, which may be any script."""
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


def _answer(there: Connection, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    _bound()
    try:
        there.send((True, function(*arguments)))
    except MemoryError:
        there.send((False, ValueError(f"reading it takes more than {MEMORY >> 20} MiB")))
    except Exception as error:
        there.send((False, ValueError(" ".join(str(error).split())[:200] or type(error).__name__)))


def _bound() -> None:
    """No more memory than `MEMORY` for this process's data from now on."""
    try:
        import resource
    except ImportError:  # no such thing here; sizes are counted before anything is read
        return
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    bound = MEMORY if most == resource.RLIM_INFINITY else min(MEMORY, most)
    resource.setrlimit(resource.RLIMIT_DATA, (bound, most))
