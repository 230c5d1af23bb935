"""A trial's log written in a thread of its own, in order, for a loop with deadlines.

For a loop with deadlines: packing, compressing and writing a chunk of a log takes up to a few
milliseconds, which a cycle of one millisecond does not have.
"""

import queue
import threading
from collections.abc import Callable, Sequence
from types import TracebackType
from typing import Any, Self

from spirob.can_protocol import CanFrame
from spirob.errors import DataError
from spirob.logs.writer import TrialLog

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


class ThreadedLog(TrialLog):
    """Writes the same bytes; an error of the disk comes back with a later cycle.

    What is handed over must not change any more.
    """

    def __enter__(self) -> Self:
        super().__enter__()
        self._background = Background()
        return self

    def frames(self, frames: Sequence[CanFrame]) -> None:
        """Keep frames soon; raises what keeping earlier ones raised."""
        self._background(super().frames, frames)

    def cycle(self, *about: Any, **named: Any) -> None:
        """Keep a cycle soon; raises what keeping earlier ones raised."""
        assert not named  # the loop gives everything by position
        self._background(super().cycle, *about)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            self._background.close()
        except BaseException as late:
            if error is None:
                super().__exit__(type(late), late, late.__traceback__)
                raise
        super().__exit__(kind, error, trace)
