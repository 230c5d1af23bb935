"""Progress of a search: a bar with the time that is left at most, else its lines as they come."""

import time
from types import TracebackType
from typing import Any, TextIO

from spirob.cli.progress import bar_of
from spirob.cli.time_left import clock
from spirob.told import Step

SHOWN = 44  # characters of a line beside the bar


class SearchProgress:
    """Context that is called with lines; those that are steps move the bar.

    quiet  say nothing
    """

    def __init__(self, stream: TextIO, quiet: bool = False):
        self._stream, self._quiet = stream, quiet
        self._begun = time.monotonic()
        self._last: Step | None = None
        self._bar: Any = None

    def __enter__(self) -> "SearchProgress":
        self._begun = time.monotonic()
        if self._stream.isatty() and not self._quiet:
            self._bar = bar_of(self._stream, self.left)
            self._bar.start()
            self._task = self._bar.add_task("logs", total=None)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.stop()

    def __call__(self, text: str) -> None:
        if self._quiet:
            return
        if self._bar is None:
            print(text, file=self._stream, flush=True)
        elif isinstance(text, Step):
            self._last = text
            shown = text if len(text) <= SHOWN else f"{text[: SHOWN - 1]}…"
            self._bar.update(self._task, description=shown, completed=text.done, total=text.of)
        else:
            self._bar.console.print(text, markup=False, highlight=False)

    def left(self) -> str:
        """Time left at most, from what a step took so far: a search may end before its last."""
        if self._last is None:
            return clock(None)
        each = (time.monotonic() - self._begun) / self._last.done
        return f"at most {clock(each * (self._last.of - self._last.done))}"
