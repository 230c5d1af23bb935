"""What a trial does about what it feels: it goes on from another row of its schedule."""

from collections.abc import Sequence
from typing import Protocol


class Reaction(Protocol):
    """Asked before each cycle whose row lies from `begins` to before `ends`.

    It is made anew for every trial that is played.
    """

    begins: int
    ends: int

    def __call__(self, row: int, currents: Sequence[float]) -> int:
        """The row to be played instead of `row`, most often the same.

        currents  that the motors last reported [A]
        """
