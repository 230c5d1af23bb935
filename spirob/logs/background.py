"""Work done in the order it was given, in a thread of its own.

For a loop with deadlines: packing, compressing and writing a chunk of a log takes up to a few
milliseconds, which a cycle of one millisecond does not have.
"""

import queue
import threading
from collections.abc import Callable
from typing import Any

from spirob.errors import DataError

MOST = 120_000  # pieces of work waiting: a minute of a loop at 1 kHz


class Background:
    """Takes calls and makes them later; what a call raises comes back at the next one.

    Nothing more is done after an error.  Not reentrant: one thread gives the work.
    """

    def __init__(self) -> None:
        self._work: queue.SimpleQueue[tuple[Callable[..., Any], tuple[Any, ...]] | None]
        self._work = queue.SimpleQueue()
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._run, name="log", daemon=True)
        self._thread.start()

    def __call__(self, function: Callable[..., Any], *arguments: Any) -> None:
        """`function(*arguments)` soon; the arguments must not change any more.

        Raises what an earlier call raised, and DataError where the work does not keep up.
        """
        if self._error is not None:
            raise self._error
        if self._work.qsize() > MOST:
            raise DataError("the log cannot be written as fast as it comes in: the disk is slow")
        self._work.put((function, arguments))

    def close(self) -> None:
        """Wait until everything is done; raises what a call raised."""
        if self._thread.is_alive():
            self._work.put(None)
            self._thread.join()
        if self._error is not None:
            raise self._error

    def _run(self) -> None:
        while (work := self._work.get()) is not None:
            function, arguments = work
            if self._error is None:
                try:
                    function(*arguments)
                except BaseException as error:
                    self._error = error
