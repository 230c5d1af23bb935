"""Run a reader in a process of its own, with bounded time and memory.

Native code that a damaged file brings down (a segmentation fault in `scipy.io.loadmat` is easily
found by flipping bytes) then takes down that process alone, and a length that a file only claims
ends there as an error.
"""

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from multiprocessing.connection import Connection
from types import ModuleType
from typing import Any

from spirob.errors import DataError
from spirob.logs.readers.columns import printable

ALWAYS = ("spirob.logs.readers", "pandas")  # loaded before the first process is forked
LONGEST = 60.0  # s
ENDING = 5.0  # s that a process has to be gone once it has closed its end
TIMED = -signal.SIGPROF if hasattr(signal, "SIGPROF") else None  # exit code, by its own timer
MEMORY = 2**30  # bytes of data, where the system can bound it
_STARTING = threading.Lock()


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
    methods = multiprocessing.get_all_start_methods()
    context: Any = multiprocessing.get_context("forkserver" if "forkserver" in methods else "spawn")
    if "forkserver" in methods:
        context.set_forkserver_preload([*ALWAYS, *needs])
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=_answer, args=(there, function, arguments), daemon=True)
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


def _answer(there: Connection, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    _bound()
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
        tell(False, DataError(printable(str(error))))
    except Exception as error:
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
