"""A program that is told to end cleans up, and takes with it what it started."""

import signal
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

import psutil

SIGNALS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))


@contextmanager
def signals_raised() -> Iterator[None]:
    """Inside, a signal to end is SystemExit with code 128 + its number, so that `finally` runs.

    Temporary folders are removed then, and pools end their workers.  Outside of the main thread
    signals stay as they are.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, _raise) for number in SIGNALS}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def ended_together(process: "subprocess.Popen[str]") -> Iterator[None]:
    """Inside, an end of ours is one of this process and of all that it started, which is awaited.

    Ctrl-C has reached them already: a terminal sends it to all that run in it.
    """
    try:
        yield
    except BaseException as end:
        if not isinstance(end, KeyboardInterrupt):
            _terminate(process)
        process.wait()
        raise


def _terminate(process: "subprocess.Popen[str]") -> None:
    with suppress(psutil.Error):
        own = psutil.Process(process.pid)
        for one in (own, *own.children(recursive=True)):
            with suppress(psutil.Error):
                one.terminate()


def _raise(number: int, frame: FrameType | None) -> None:
    raise SystemExit(128 + number)
