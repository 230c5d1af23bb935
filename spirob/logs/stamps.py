"""The stamps of a log in their order: wrapped counters, rows out of place, clocks begun again.

What is certain is repaired and said; a column that is no time is refused.
"""

from bisect import bisect_right
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter

from spirob.errors import DataError

COUNTERS = (2.0**16, 2.0**24, 2.0**32)  # counts after which a counter begins again
SCALES = tuple(10.0**k for k in (-9, -6, -3, 0, 3, 6, 9))  # of a counter in another unit
ROUNDS = (1.0, 86400.0)  # s: the part below a second, and the time of a day
NEAR = 0.05  # of a counter by which a step back may be short, where rows are lost
GAP = 5.5  # periods that are no gap yet
MISPLACED = 0.05  # of the rows may be out of place or begin again; more is no clock
FEW = 10  # rows that may be so in any case
BESIDE = 5  # rows on either side that say where a row belongs


@dataclass(frozen=True)
class Ordered:
    """Rows of a log in the order of their stamps.

    rows    those that have a time, (n,)
    stamps  theirs in the log's own unit, (n,), never falling within a stretch
    begins  where stretches begin, (k,): 0, and where the clock starts again
    """

    rows: np.ndarray
    stamps: np.ndarray
    begins: np.ndarray


def ordered(where: str, stamps: np.ndarray, unit: float, said: list[str]) -> Ordered:
    """The rows in order of time; `unit` is seconds a unit of the stamps.

    Raises DataError where fewer than two rows have a time, and where the column is no time.
    """
    rows = np.flatnonzero(np.isfinite(stamps))
    if len(rows) < 2:
        raise DataError(f"{where}: fewer than two rows have a time")
    if len(rows) < len(stamps):
        said.append(f"{where}: {len(stamps) - len(rows)} rows without a time left out.")
    values = _continued(where, stamps[rows], unit, said)
    falls = np.flatnonzero(np.diff(values) < 0) + 1
    if len(falls) > max(FEW, MISPLACED * len(values)):
        raise DataError(
            f"{where}: time runs backwards in {len(falls)} of {len(values)} rows, first in row "
            f"{rows[falls[0]] + 1}; is it another column?"
        )
    if not len(falls):
        return Ordered(rows, values, np.array([0]))
    begins = np.array([0, *_begun_again(values, falls)])
    found = [_in_order(part) for part in np.split(values, begins[1:])]
    if len(begins) > 1:
        again = len(begins) - 1
        first = rows[begins[1]] + 1
        said.append(f"{where}: the clock starts again {_times(again)}, first in row {first}.")
    put = sum(len(keep) - len(_longest_rising(keep)) for keep in found)
    lost = len(values) - sum(map(len, found))
    if put:
        said.append(f"{where}: {put} rows out of place put in order of time.")
    if lost:
        said.append(f"{where}: {lost} rows whose time does not increase were dropped.")
    index = np.concatenate([b + keep for b, keep in zip(begins, found, strict=True)])
    starts = np.cumsum([0, *(len(keep) for keep in found)])[:-1]
    return Ordered(rows[index], values[index], starts)


def _continued(where: str, values: np.ndarray, unit: float, said: list[str]) -> np.ndarray:
    """A counter that wraps round goes on."""
    steps = np.diff(values)
    falls = np.flatnonzero(steps < 0)
    if not len(falls):
        return values
    room = GAP * float(np.median(steps))
    wide = [(count, NEAR * count) for count in COUNTERS]
    narrow = [(count * scale, room) for count in COUNTERS for scale in SCALES]
    narrow += [(seconds / unit, room) for seconds in ROUNDS]
    low, high = float(values.min()), float(values.max())
    for modulus, short in [*narrow, *wide]:
        wraps = falls[(steps[falls] > -modulus) & (steps[falls] <= short - modulus)]
        inside = (low >= 0 and high < modulus) or (-modulus <= 2 * low and 2 * high < modulus)
        if len(wraps) and inside:
            said.append(f"{where}: the clock wrapped {_times(len(wraps))} and is continued.")
            turns = np.zeros(len(values))
            turns[wraps + 1] = modulus
            return np.asarray(values + np.cumsum(turns))
    return values


def _begun_again(values: np.ndarray, falls: np.ndarray) -> list[int]:
    """Rows at which the clock starts again: those around stay behind those before."""
    middle = median_filter(values, 2 * BESIDE + 1, mode="nearest")
    before = middle[np.maximum(falls - 1 - BESIDE, 0)]
    after = middle[np.minimum(falls + BESIDE, len(values) - 1)]
    again = falls[after < before]
    if not len(again):
        return []
    sizes = values[again] - values[again - 1]
    groups = np.split(np.arange(len(again)), np.flatnonzero(np.diff(again) > 2 * BESIDE) + 1)
    return [int(again[g[np.argmin(sizes[g])]]) for g in groups]


def _in_order(values: np.ndarray) -> np.ndarray:
    """Index of the rows of a stretch by time, without those whose stamp belongs elsewhere."""
    kept = _longest_rising(values)
    out = np.setdiff1d(np.arange(len(values)), kept, assume_unique=True)
    at = np.searchsorted(kept, out)
    low = values[kept[np.maximum(at - BESIDE, 0)]]
    high = values[kept[np.minimum(at + BESIDE, len(kept)) - 1]]
    near = out[(values[out] >= low) & (values[out] <= high)]
    every = np.concatenate([kept, near])
    return np.asarray(every[np.argsort(values[every], kind="stable")])


def _longest_rising(values: np.ndarray) -> np.ndarray:
    """Index of the longest subsequence that never falls."""
    tops: list[float] = []
    ends: list[int] = []
    before = np.full(len(values), -1)
    for k, value in enumerate(values.tolist()):
        place = bisect_right(tops, value)
        before[k] = ends[place - 1] if place else -1
        if place == len(tops):
            tops.append(value)
            ends.append(k)
        else:
            tops[place], ends[place] = value, k
    found, k = [], ends[-1]
    while k >= 0:
        found.append(k)
        k = int(before[k])
    return np.array(found[::-1])


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"
