"""Run a reader in a process of its own.

Native code that a damaged file brings down (a segmentation fault in `scipy.io.loadmat` is easily
found by flipping bytes) then takes down that process alone.
"""

import multiprocessing
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

LONGEST = 60.0  # s


class Crashed(ValueError):
    """The reader's process ended without an answer."""


def apart(function: Callable[..., Any], *arguments: Any) -> Any:
    """`function(*arguments)` of a module's top level, run apart.

    Raises what it raises, and Crashed where its process dies or takes longer than a minute.
    """
    methods = multiprocessing.get_all_start_methods()
    context: Any = multiprocessing.get_context("forkserver" if "forkserver" in methods else "spawn")
    if "forkserver" in methods:
        context.set_forkserver_preload([function.__module__])
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=_answer, args=(there, function, arguments), daemon=True)
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


def _answer(there: Connection, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    try:
        there.send((True, function(*arguments)))
    except Exception as error:
        there.send((False, ValueError(" ".join(str(error).split())[:200] or type(error).__name__)))
