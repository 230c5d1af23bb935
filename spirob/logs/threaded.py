"""A trial's log that is written in a thread of its own, for a loop with deadlines."""

from collections.abc import Sequence
from types import TracebackType
from typing import Any, Self

from spirob.can_protocol import CanFrame
from spirob.logs.background import Background
from spirob.logs.writer import TrialLog


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
