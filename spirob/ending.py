"""How processes end: SIGTERM as Ctrl-C does, none outlives the one that started it, no leftovers.

    python -m spirob.ending MODULE ...

runs a module that is not ours so, with all that it starts in its group of processes.
"""

import argparse
import os
import runpy
import signal
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache

EVERY = 0.5  # s, between two looks at the parent
_LEFT: list[Callable[[], object]] = []


def at_end(action: Callable[[], object]) -> None:
    """`action` takes away what this process leaves elsewhere, also where its end is cut short."""
    _LEFT.append(action)


def tidy() -> None:
    """Take away what is left; for an end that runs nothing else (`os._exit`)."""
    while _LEFT:
        with suppress(Exception):
            _LEFT.pop()()


def stop_as_by_hand() -> None:
    """From now on SIGTERM and SIGHUP raise KeyboardInterrupt, so that what is open is closed.

    A signal that is ignored (nohup) or handled stays so; outside of the main thread nothing
    happens.
    """
    if threading.current_thread() is not threading.main_thread():
        return
    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, signal.default_int_handler)


@cache
def end_with_parent() -> None:
    """This process gets SIGTERM once its parent is gone, and so does the group that it leads."""
    threading.Thread(target=_watch, args=(os.getppid(),), daemon=True).start()


def _watch(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(EVERY)
    if os.getpgrp() == os.getpid():
        os.killpg(os.getpid(), signal.SIGTERM)
    else:
        os.kill(os.getpid(), signal.SIGTERM)


def main() -> None:
    """Run the module that the command line names, with the arguments that follow it."""
    raw = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=raw)
    parser.add_argument("module")
    parser.add_argument("given", nargs=argparse.REMAINDER)
    chosen = parser.parse_args()
    end_with_parent()
    sys.argv[:] = [chosen.module, *chosen.given]
    runpy.run_module(chosen.module, run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    main()
