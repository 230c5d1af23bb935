"""Lines of progress of a search that may end early: each says how many steps it can be at most."""

from collections.abc import Callable


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
