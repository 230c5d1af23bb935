"""An even clock behind stamps that are coarse, late, or come in bursts.

A row that begins a new stamp tells when it was; the others lie between.  Straight lines through
these rows, as few as will do, are the clock: what stays to one side of a line is lost samples.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.ndimage import median_filter

from spirob.logs.stamps import GAP

EVEN = 0.2  # of a period by which the steps of a clock may be off
MOSTLY = 0.99  # of them
SAME = 1e-3  # of a period: stamps that close are one
SHORTEST = 0.25  # s; runs that are all shorter, between gaps, are bursts
BURSTS = 3  # of them at least
FASTER = 0.5  # of the time that they take in all: else samples are lost between them
BESIDE = 31  # stamps by which a period is told, and whether a line fits
ROUNDS = 4  # of a fit to the middle of the stamps, from which a few may be far
CLOSEST = 0.1  # of a period: rows follow one another by at least that


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


def even_clock(stamps: np.ndarray) -> EvenClock:
    """The clock of a stretch, (n,) stamps that never fall, three of them different."""
    steps = np.diff(stamps)
    new = steps > SAME * np.ptp(stamps) / len(stamps)
    first = np.flatnonzero(np.concatenate([[True], new]))
    usual = float(np.median(np.diff(stamps[first])))
    first = _bursts(stamps, first, usual)
    if len(first) < MOSTLY * len(stamps):
        return _straightened(stamps, first)
    ratio = steps / usual
    whole = np.maximum(np.rint(ratio), 1.0)
    even = np.abs(ratio - whole) <= EVEN
    if np.mean(even | (ratio > GAP)) < MOSTLY:
        return _straightened(stamps, first)
    near = even & (ratio <= GAP)
    period = float(steps[near].sum() / whole[near].sum())
    return EvenClock(period, 1.0, _spread(stamps, first, period), None)


def _bursts(stamps: np.ndarray, first: np.ndarray, usual: float) -> np.ndarray:
    """First rows of bursts, where runs between gaps are that; else `first`."""
    gaps = np.flatnonzero(np.diff(stamps) > GAP * usual) + 1
    runs = stamps[np.append(gaps - 1, -1)] - stamps[np.insert(gaps, 0, 0)]
    bursts = runs.max() < SHORTEST and runs.sum() < FASTER * np.ptp(stamps)
    return np.insert(gaps, 0, 0) if len(gaps) >= BURSTS and bursts else first


def _spread(stamps: np.ndarray, first: np.ndarray, period: float) -> np.ndarray:
    """Times of the rows, those of one stamp between it and the next."""
    end = stamps[first[-1]] + period * (len(stamps) - first[-1])
    known = np.append(first, len(stamps))
    return np.interp(np.arange(len(stamps)), known, np.append(stamps[first], end))


def _straightened(stamps: np.ndarray, first: np.ndarray) -> EvenClock:
    far = max(1, min(BESIDE, len(first) // 8))  # so that few reach across a gap
    told = stamps[first]
    period = float(np.median((told[far:] - told[:-far]) / (first[far:] - first[:-far])))
    given = _spread(stamps, first, period)
    even = np.empty(len(stamps))
    edges = [0, *_gaps(told, first, period), len(first)]
    for left, right in pairwise(edges):
        begin, end = first[left], first[right] if right < len(first) else len(stamps)
        # the first row of a block need not begin its stamp
        known = slice(left + 1 if right - left > 3 else left, right)
        even[begin:end] = _lines(first[known], told[known], period, begin, end)
    least = CLOSEST * period * np.arange(len(stamps))
    even = np.maximum.accumulate(even - least) + least
    return EvenClock(float(np.median(np.diff(even))), float(np.median(np.diff(first))), given, even)


def _gaps(stamps: np.ndarray, rows: np.ndarray, period: float) -> np.ndarray:
    """Stamps before which samples are missing; after a stall the rows catch up."""
    apart = np.diff(stamps)
    after = np.flatnonzero(apart > GAP * np.median(apart)) + 1
    ahead = median_filter(stamps - period * rows, BESIDE, mode="nearest")
    half = BESIDE // 2
    shift = ahead[np.minimum(after + half, len(rows) - 1)] - ahead[np.maximum(after - 1 - half, 0)]
    return after[shift > 0.5 * apart[after - 1]]


def _lines(
    index: np.ndarray, stamps: np.ndarray, period: float, begin: int, end: int
) -> np.ndarray:
    """Times of the rows from begin to end, on few straight lines through stamps of some of them."""
    if len(index) < 3:
        return stamps[0] + period * (np.arange(begin, end) - index[0])
    x, y = index - index[0], stamps - stamps[0]
    slope, height = np.polyfit(x, y, 1)
    for _ in range(ROUNDS):
        near = np.maximum(np.abs(y - height - slope * x), 0.25 * period)
        slope, height = np.polyfit(x, y, 1, w=near**-0.5)
    line = stamps[0] + height + slope * (np.arange(begin, end) - index[0])
    off = y - height - slope * x
    if len(index) >= 3 * BESIDE:
        aside = np.abs(median_filter(off, BESIDE, mode="nearest"))
        scatter = 1.48 * float(np.median(np.abs(np.diff(off)))) / np.sqrt(2)
        if aside[BESIDE:-BESIDE].max() > 0.5 * period + scatter:
            gathered = np.abs(np.cumsum(np.clip(off, -2 * period, 2 * period)))
            cut = BESIDE + int(np.argmax(gathered[BESIDE:-BESIDE])) + 1
            left = _lines(index[:cut], stamps[:cut], period, begin, int(index[cut]))
            right = _lines(index[cut:], stamps[cut:], period, int(index[cut]), end)
            return np.concatenate([left, right])
    return line
