"""Frames to cycles: gaps hold the value before, of duplicates the last counts."""

import numpy as np

from spirob.can_protocol import COUNTS_PER_TURN
from spirob.errors import DataError
from spirob.logs.transmission import HALF_TURN
from spirob.robot import CYCLE_NS

LONGEST_TRIAL = 24 * 3600 * 1000  # cycles; more is a broken time stamp


def rows_of(stamps: np.ndarray) -> np.ndarray:
    """The cycle each stamp belongs to, counted from the first."""
    if not np.all(stamps[1:] > stamps[:-1]):
        raise DataError("the time stamps of the commands do not increase")
    if int(stamps[-1]) - int(stamps[0]) >= LONGEST_TRIAL * CYCLE_NS:
        raise DataError("the time stamps span more than a day")
    return np.rint((stamps - stamps[0]) / CYCLE_NS).astype(np.int64)


def hold(rows: np.ndarray, cycles: int) -> tuple[np.ndarray, int, int]:
    """For each cycle the index of its latest sample, holding over gaps; gaps and duplicates.

    The cycles before the first sample take the first.
    """
    latest = np.full(cycles, -1)
    np.maximum.at(latest, rows, np.arange(len(rows)))
    filled = int(np.count_nonzero(latest >= 0))
    held = np.maximum(np.maximum.accumulate(latest), 0)
    return held, cycles - filled, len(rows) - filled


def unwrap(angle: np.ndarray) -> np.ndarray:
    """Counts since the first sample; right as long as a sample turns less than half a turn."""
    counts = angle.astype(np.int64)
    step = np.zeros_like(counts)
    step[1:] = counts[1:] - counts[:-1]
    return np.cumsum(np.mod(step + HALF_TURN, COUNTS_PER_TURN) - HALF_TURN)
