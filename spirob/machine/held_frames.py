"""Rows in which a logger held the frame before, as it had no new one, while the axis moved on.

Every channel repeats exactly.  So it does where an axis stands under an effort without noise, or
where coarse channels are the same by chance; but from rest an axis starts slowly, and by chance it
moves by no more than one count.  Behind a held frame it is at speed at once, and has caught up.
"""

from collections.abc import Iterable

import numpy as np

CAUGHT = 0.4  # of the way at the speed beside, to be moved over a held frame; from rest a quarter
BESIDE = 2  # fresh rows on either side that tell that speed
COUNT = 1.5  # times the smallest step: it moved by more than one count
MOST = 0.5  # of the runs that end in motion are held frames; of the moving rows, or of all


def held(still: np.ndarray, positions: Iterable[np.ndarray]) -> np.ndarray:
    """Rows that hold the frame before while the axis moves, a mask (n,).

    still      (n - 1,): every channel is as in the row before;  positions  (n,) each
    """
    dropped = np.zeros(len(still) + 1, bool)
    fresh = np.flatnonzero(np.append(True, ~still))
    if still.any() and len(fresh) > 2 * BESIDE:
        for values in positions:
            dropped |= _held(values, fresh)
    return dropped


def _held(values: np.ndarray, fresh: np.ndarray) -> np.ndarray:
    """The same as one position tells it; fresh are the rows with a frame of their own.

    Where most rows of the motion are held, the log is that of a slower clock: repeats go, and of a
    stand, which is longer than any hold, as many rows stay as that clock has.
    """
    many = np.diff(np.append(fresh, len(values)))
    steps = np.append(np.diff(values[fresh]), 0.0)
    moves = np.abs(steps) > COUNT * _count(steps)
    ends = moves & (many > 1)
    caught = ends & _goes_on(steps / many)
    repeats = np.arange(len(values)) - np.repeat(fresh, many)
    if not caught.any() or caught.sum() <= MOST * ends.sum():
        return np.zeros(len(values), bool)
    hold, moving = many <= many[caught].max(), many[caught | (moves & (many == 1))]
    if np.sum(moving - 1) > MOST * np.sum(moving):
        kept = (repeats % int(np.median(moving)) == 0) & np.repeat(~hold, many)
    else:
        kept = np.repeat(~(moves & hold), many)
    return (repeats > 0) & ~kept


def _count(steps: np.ndarray) -> float:
    sizes = np.abs(steps[np.isfinite(steps) & (steps != 0)])
    return float(sizes.min()) if len(sizes) else np.inf


def _goes_on(rates: np.ndarray) -> np.ndarray:
    """Whether each rate is that of the fresh rows beside it, neither a rest nor a jump, (n,)."""
    count = len(rates)
    padded = np.pad(rates, BESIDE, mode="edge")
    places = [k for k in range(2 * BESIDE + 1) if k != BESIDE]
    usual = np.median([padded[k : k + count] for k in places], axis=0)
    ratio = np.divide(rates, usual, out=np.zeros(count), where=usual != 0)
    return np.asarray((ratio >= CAUGHT) & (ratio <= 1.0 / CAUGHT))
