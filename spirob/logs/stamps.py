"""The stamps of a log in their order, and an even clock behind stamps that are coarse or late.

What is certain is repaired and said; a column that is no time is refused.

A row that begins a new stamp tells when it was; the others lie between.  Straight lines through
these rows, as few as will do, are the clock: what stays to one side of a line is lost samples.
"""

from bisect import bisect_right
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.ndimage import median_filter

from spirob.errors import DataError, NothingLeft

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

    Raises NothingLeft where fewer than two rows have a time, DataError where the column is no time.
    """
    rows = np.flatnonzero(np.isfinite(stamps))
    if len(rows) < 2:
        raise NothingLeft(f"{where}: fewer than two rows have a time")
    if len(rows) < len(stamps):
        said.append(f"{where}: {len(stamps) - len(rows)} rows without a time left out.")
    values = _continued(where, stamps[rows], unit, said)
    falls = np.flatnonzero(np.diff(values) < 0) + 1
    if len(falls) > max(FEW, MISPLACED * len(values)):
        raise DataError(
            f"{where}: time runs backwards in {len(falls)} of {len(values)} rows, first in row "
            f"{rows[falls[0]] + 1}; is it another column?"
        )
    begins = np.array([0, *_begun_again(values, falls)])
    found = [_in_order(part) for part in np.split(values, begins[1:])]
    if len(begins) > 1:
        again = len(begins) - 1
        first = rows[begins[1]] + 1
        said.append(f"{where}: the clock starts again {_times(again)}, first in row {first}.")
    moved = [keep for keep in found if np.any(np.diff(keep) < 0)]
    put = sum(len(keep) - len(_longest_rising(keep)) for keep in moved)
    lost = len(values) - sum(map(len, found))
    if put:
        said.append(f"{where}: {put} rows out of place put in order of time.")
    if lost:
        said.append(
            f"{where}: {lost} rows whose time does not follow from those beside were dropped."
        )
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
    inner = (falls > BESIDE) & (falls < len(values) - BESIDE)
    again = falls[inner & (after < before)]
    if not len(again):
        return []
    sizes = values[again] - values[again - 1]
    groups = np.split(np.arange(len(again)), np.flatnonzero(np.diff(again) > 2 * BESIDE) + 1)
    return [int(again[g[np.argmin(sizes[g])]]) for g in groups]


def _in_order(values: np.ndarray) -> np.ndarray:
    """Index of the rows of a stretch by time, without those whose stamp belongs elsewhere."""
    if not np.any(np.diff(values) < 0):
        return np.arange(len(values))[_together(values)]
    kept = _longest_rising(values)
    out = np.setdiff1d(np.arange(len(values)), kept, assume_unique=True)
    at = np.searchsorted(kept, out)
    low = values[kept[np.maximum(at - BESIDE, 0)]]
    high = values[kept[np.minimum(at + BESIDE, len(kept)) - 1]]
    near = out[(values[out] >= low) & (values[out] <= high)]
    every = np.concatenate([kept, near])
    every = every[np.argsort(values[every], kind="stable")]
    return every[_together(values[every])]


def _together(values: np.ndarray) -> slice:
    """Without the few first or last rows that lie further off than all others are apart."""
    if len(values) <= 4 * BESIDE:
        return slice(None)
    far = np.diff(values) > values[-BESIDE - 1] - values[BESIDE]
    first, last = np.flatnonzero(far[:BESIDE]), np.flatnonzero(far[-BESIDE:])
    begin = int(first[-1]) + 1 if len(first) else 0
    return slice(begin, len(values) - BESIDE + int(last[0]) if len(last) else None)


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


EVEN = 0.2  # of a period by which the steps of a clock may be off
MOSTLY = 0.99  # of them
SAME = 1e-3  # of a period: stamps that close are one
SHORTEST = 0.25  # s; runs that are all shorter, between gaps, are bursts
BURSTS = 3  # of them at least
FASTER = 0.5  # of the time that they take in all: else samples are lost between them
STAMPS_BESIDE = 31  # stamps by which a period is told, and whether a line fits
FIT_ROUNDS = 4  # of a fit to the middle of the stamps, from which a few may be far
CLOSEST = 0.1  # of a period: rows follow one another by at least that
HALF = 0.5  # of a period, by which they do where their stamps are as far apart


@dataclass(frozen=True)
class EvenClock:
    """What a stretch's stamps say of its rows.

    period  of the samples;  shared  rows to a stamp or burst, on average
    given   each row's time by its stamp, rows of one stamp spread up to the next, (n,)
    even    each row's time on the even clock, (n,); None where the stamps are even already
    """

    period: float
    shared: float
    given: np.ndarray
    even: np.ndarray | None


def even_clock(stamps: np.ndarray, places: np.ndarray | None = None) -> EvenClock:
    """The clock of a stretch, (n,) stamps that never fall, three of them different.

    places  (n,) of the rows among all that were logged; absent: none is left out
    """
    at = np.arange(len(stamps)) if places is None else places - places[0]
    steps = np.diff(stamps)
    near = steps[steps <= np.quantile(steps, MOSTLY)]  # a clock may be set by years within a log
    new = steps > SAME * np.mean(near)
    first = np.flatnonzero(np.concatenate([[True], new]))
    usual = float(np.median(np.diff(stamps[first])))
    first = _bursts(stamps, first, usual)
    if len(first) < MOSTLY * len(stamps):
        return _straightened(stamps, first, at)
    ratio = steps / usual
    whole = np.maximum(np.rint(ratio), 1.0)
    even = np.abs(ratio - whole) <= EVEN
    if np.mean(even | (ratio > GAP)) < MOSTLY:
        return _straightened(stamps, first, at)
    near = even & (ratio <= GAP)
    period = float(steps[near].sum() / whole[near].sum())
    return EvenClock(period, 1.0, _spread(stamps, first, at, period), None)


def _bursts(stamps: np.ndarray, first: np.ndarray, usual: float) -> np.ndarray:
    """First rows of bursts, where runs between gaps are that; else `first`."""
    gaps = np.flatnonzero(np.diff(stamps) > GAP * usual) + 1
    runs = stamps[np.append(gaps - 1, -1)] - stamps[np.insert(gaps, 0, 0)]
    bursts = runs.max() < SHORTEST and runs.sum() < FASTER * np.ptp(stamps)
    return np.insert(gaps, 0, 0) if len(gaps) >= BURSTS and bursts else first


def _spread(stamps: np.ndarray, first: np.ndarray, at: np.ndarray, period: float) -> np.ndarray:
    """Times of the rows, those of one stamp between it and the next."""
    end = stamps[first[-1]] + period * (at[-1] + 1 - at[first[-1]])
    known = np.append(at[first], at[-1] + 1)
    return np.interp(at, known, np.append(stamps[first], end))


def _straightened(stamps: np.ndarray, first: np.ndarray, at: np.ndarray) -> EvenClock:
    far = max(1, min(STAMPS_BESIDE, len(first) // 8))  # so that few reach across a gap
    told, begun = stamps[first], at[first]
    period = float(np.median((told[far:] - told[:-far]) / (begun[far:] - begun[:-far])))
    given = _spread(stamps, first, at, period)
    even = np.empty(len(stamps))
    edges = [0, *_gaps(told, begun, period), len(first)]
    for left, right in pairwise(edges):
        rows = slice(first[left], first[right] if right < len(first) else len(stamps))
        # the first row of a block need not begin its stamp
        known = slice(left + 1 if right - left > 3 else left, right)
        even[rows] = _lines(begun[known], told[known], period, at[rows])
    # where lines meet, rows are as far apart as their stamps, up to half a period, not closer
    apart = np.clip(np.diff(given), CLOSEST * period, HALF * period)
    least = np.concatenate([[0.0], np.cumsum(apart)])
    even = np.maximum.accumulate(even - least) + least
    return EvenClock(float(np.median(np.diff(even))), float(np.median(np.diff(first))), given, even)


def _gaps(stamps: np.ndarray, rows: np.ndarray, period: float) -> np.ndarray:
    """Stamps before which samples are missing; after a stall the rows catch up."""
    apart = np.diff(stamps)
    after = np.flatnonzero(apart > GAP * np.median(apart)) + 1
    ahead = median_filter(stamps - period * rows, STAMPS_BESIDE, mode="nearest")
    half = STAMPS_BESIDE // 2
    shift = ahead[np.minimum(after + half, len(rows) - 1)] - ahead[np.maximum(after - 1 - half, 0)]
    return after[shift > 0.5 * apart[after - 1]]


def _lines(index: np.ndarray, stamps: np.ndarray, period: float, rows: np.ndarray) -> np.ndarray:
    """Times of rows, (n,), on few straight lines through stamps of some of them, (k,)."""
    if len(index) < 3:
        return stamps[0] + period * (rows - index[0])
    x, y = index - index[0], stamps - stamps[0]
    slope, height = np.polyfit(x, y, 1)
    for _ in range(FIT_ROUNDS):
        near = np.maximum(np.abs(y - height - slope * x), 0.25 * period)
        slope, height = np.polyfit(x, y, 1, w=near**-0.5)
    line = stamps[0] + height + slope * (rows - index[0])
    off = y - height - slope * x
    if len(index) >= 3 * STAMPS_BESIDE:
        aside = np.abs(median_filter(off, STAMPS_BESIDE, mode="nearest"))
        scatter = 1.48 * float(np.median(np.abs(np.diff(off)))) / np.sqrt(2)
        if aside[STAMPS_BESIDE:-STAMPS_BESIDE].max() > 0.5 * period + scatter:
            gathered = np.abs(np.cumsum(np.clip(off, -2 * period, 2 * period)))
            cut = STAMPS_BESIDE + int(np.argmax(gathered[STAMPS_BESIDE:-STAMPS_BESIDE])) + 1
            parts = np.split(rows, [int(np.searchsorted(rows, index[cut]))])
            left = _lines(index[:cut], stamps[:cut], period, parts[0])
            return np.concatenate([left, _lines(index[cut:], stamps[cut:], period, parts[1])])
    return line
