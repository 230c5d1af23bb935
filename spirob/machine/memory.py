"""What effects remember from one piece of a log to the next.

Through a gap a memory takes up a straight line from the signals before it to those behind it: heat,
bristles and lags go on, as they do in the machine.  Only with a log does memory begin anew.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

IN_GAP = 1000  # rows at most; a longer gap is gone through in longer steps


@dataclass(frozen=True)
class Way:
    """The rows that a memory takes up one after the other: m, of which n are the motion's.

    starts (parts + 1,), steps (parts,), anew (parts,)  as `kernel_loop.loop_of` says
    before, behind  (m,) rows of the motion that a row lies between
    share  (m,) of the way from the one to the other;  rows  (n,) those that are the motion's
    """

    starts: np.ndarray
    steps: np.ndarray
    anew: np.ndarray
    before: np.ndarray
    behind: np.ndarray
    share: np.ndarray
    rows: np.ndarray

    def over(self, values: np.ndarray) -> np.ndarray:
        """Values at the rows of a motion, (k, n), along this way, (k, m)."""
        if len(self.rows) == len(self.share):
            return values
        here, there = values[:, self.before], values[:, self.behind]
        return np.asarray(here + self.share * (there - here))


def apart(starts: np.ndarray, steps: np.ndarray) -> Way:
    """The way of a memory that begins anew with every piece."""
    rows = np.arange(starts[-1])
    return Way(starts, steps, np.ones(len(steps), bool), rows, rows, np.zeros(len(rows)), rows)


def bridged(
    starts: np.ndarray, steps: np.ndarray, seconds: np.ndarray, follows: Sequence[bool]
) -> Way:
    """The way of a memory that goes on through the gaps; arguments as in `motion.Motion`."""
    before, behind, share, ends, paces, anew = [], [], [], [0], [], []

    def part(from_rows: np.ndarray, to_rows: np.ndarray, shares: np.ndarray, step: float) -> None:
        before.append(from_rows)
        behind.append(to_rows)
        share.append(shares)
        ends.append(ends[-1] + len(shares))
        paces.append(step)

    for k, step in enumerate(steps):
        begin, end = starts[k], starts[k + 1]
        if follows[k]:
            gap = float(seconds[begin] - seconds[begin - 1])
            count = int(np.clip(round(gap / step) - 1, 1, IN_GAP))
            rows = np.full(count, begin)
            part(rows - 1, rows, np.arange(1, count + 1) / (count + 1), gap / (count + 1))
            anew.append(False)
        rows = np.arange(begin, end)
        part(rows, rows, np.zeros(len(rows)), step)
        anew.append(not follows[k])
    shares = np.concatenate(share)
    return Way(
        np.array(ends),
        np.array(paces),
        np.array(anew),
        np.concatenate(before),
        np.concatenate(behind),
        shares,
        np.flatnonzero(shares == 0.0),
    )
