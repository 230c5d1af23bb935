"""Progress over units of work: a bar with the time left on a terminal, else a line for each unit.

Both go to stderr, so that what a command prints can be piped.  Colours only on a terminal, and
none where NO_COLOR is set.
"""

import sys
import time
from collections.abc import Callable, Mapping, Sequence
from types import TracebackType
from typing import Any, TextIO

from spirob.cli.time_left import TimeLeft, clock


class Progress:
    """Context in which units are begun and done, in order.

    units     names of all units;  expected  seconds that they took last time, where known
    """

    def __init__(
        self,
        units: Sequence[str],
        expected: Mapping[str, float] | None = None,
        stream: TextIO | None = None,
    ):
        self._units = list(units)
        self._left = TimeLeft(units, expected)
        self._stream = stream or sys.stderr
        self._begun = time.monotonic()
        self._count = 0
        self._bar: Any = None
        self.taken: dict[str, float] = {}

    def __enter__(self) -> "Progress":
        if self._stream.isatty():
            self._bar = bar_of(self._stream, self.left)
            self._bar.start()
            self._task = self._bar.add_task("", total=len(self._units))
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.stop()

    def begin(self, unit: str) -> None:
        """A unit starts."""
        self._begun = time.monotonic()
        if self._bar is not None:
            self._bar.update(self._task, description=unit)

    def done(self, unit: str, note: str = "", said: str = "") -> None:
        """A unit is over; with a note, such as 'unchanged', it had nothing to do.

        said  its line, where there is more to tell than how long it took
        """
        seconds = time.monotonic() - self._begun
        self._begun = time.monotonic()
        self._count += 1
        if not note:
            self.taken[unit] = seconds
        self._left.done(unit, seconds, worked=not note)
        if self._bar is not None:
            self._bar.update(self._task, description=unit, completed=self._count)
        if said or self._bar is None:
            took = f"{unit}: {note or f'{seconds:.1f} s'} ({self._count} of {len(self._units)})"
            self.tell(said or took)

    def tell(self, text: str) -> None:
        """A line of its own, above the bar where there is one."""
        if self._bar is not None:
            self._bar.console.print(text, markup=False, highlight=False)
        else:
            print(text, file=self._stream, flush=True)

    def left(self) -> str:
        """Time left, as the bar shows it."""
        return clock(self._left.seconds(time.monotonic() - self._begun))


def bar_of(stream: TextIO, left: Callable[[], str]) -> Any:
    """A bar with count and time left, as `left` tells it."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, ProgressColumn, Task, TextColumn
    from rich.progress import Progress as Bar
    from rich.text import Text

    class Left(ProgressColumn):
        def render(self, task: Task) -> Text:
            return Text(f"{left()} left", no_wrap=True)

    columns = (TextColumn("{task.description:12}"), BarColumn(), MofNCompleteColumn(), Left())
    return Bar(*columns, console=Console(file=stream), refresh_per_second=4)
