"""Progress on a terminal as a bar with the time left, else as lines; and the steps of a search.

Both go to stderr, so that what a command prints can be piped.  Colours only on a terminal, and
none where NO_COLOR is set.  A search may end early: its lines say how many steps it can be at most.
"""

import sys
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TextIO


class Step(str):
    """A line of progress, said when `done` of at most `of` steps are over."""

    done: int
    of: int

    def __new__(cls, text: str, done: int, of: int) -> "Step":
        line = super().__new__(cls, text)
        line.done, line.of = done, of
        return line


class Steps:
    """Counts what is told; each line is a step.

    tell  where the lines go;  expected  steps at most, as far as is known
    """

    def __init__(self, tell: Callable[[str], None], expected: int):
        self._tell = tell
        self.done, self.expected = 0, expected

    def __call__(self, text: str) -> None:
        self.done += 1
        self._tell(Step(text, self.done, max(self.done, self.expected)))

    def expect(self, further: int) -> None:
        """From here so many further steps at most."""
        self.expected = self.done + further


class TimeLeft:
    """Expected remaining time of a list of units that are done in order.

    units     names in order;  expected  seconds that a unit took last time, where known
    """

    def __init__(self, units: Sequence[str], expected: Mapping[str, float] | None = None):
        self._left = list(units)
        self._expected = dict(expected or {})
        self._taken: list[float] = []

    def done(self, unit: str, seconds: float, worked: bool = True) -> None:
        """A unit is over; one that had nothing to do says nothing about the others."""
        if unit in self._left:
            self._left.remove(unit)
        if worked:
            self._taken.append(seconds)

    def seconds(self, in_current: float = 0.0) -> float | None:
        """Seconds to the end, `in_current` of them being spent; None while nothing tells."""
        mean = sum(self._taken) / len(self._taken) if self._taken else None
        parts = [self._expected.get(unit, mean) for unit in self._left]
        known = [part for part in parts if part is not None]
        if len(known) < len(parts):
            return None
        first = max(0.0, known[0] - in_current) if known else 0.0
        return first + sum(known[1:])


def clock(seconds: float | None) -> str:
    """Minutes and seconds, as 4:07; a dash where it is not known."""
    if seconds is None:
        return "–:––"
    whole = round(seconds)
    return f"{whole // 60}:{whole % 60:02d}"


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

    def __exit__(self, *error: object) -> None:
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
