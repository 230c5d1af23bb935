"""Progress of a search: a bar with the time that is left at most, else its lines as they come."""

import time
from typing import TextIO

from spirob.cli.progress import Progress
from spirob.cli.time_left import clock
from spirob.told import Step

SHOWN = 44  # characters of a line beside the bar


class SearchProgress(Progress):
    """Context that is called with lines; those that are steps move the bar.

    quiet  say nothing
    """

    def __init__(self, stream: TextIO, quiet: bool = False):
        super().__init__([], stream=stream)
        self._quiet = quiet
        self._last: Step | None = None

    def __enter__(self) -> "SearchProgress":
        if not self._quiet:
            super().__enter__()
        return self

    def __call__(self, text: str) -> None:
        if self._quiet:
            return
        if self._bar is None or not isinstance(text, Step):
            self.tell(text)
            return
        self._last = text
        shown = text if len(text) <= SHOWN else f"{text[: SHOWN - 1]}…"
        self._bar.update(self._task, description=shown, completed=text.done, total=text.of)

    def left(self) -> str:
        """Time left at most, from what a step took so far: a search may end before its last."""
        if self._last is None:
            return clock(None)
        each = (time.monotonic() - self._begun) / self._last.done
        return f"at most {clock(each * (self._last.of - self._last.done))}"
