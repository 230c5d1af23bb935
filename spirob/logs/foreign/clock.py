"""Stamps of a file to strictly increasing nanoseconds; what is repaired is said.

A counter of 16 or 32 bits that wraps is followed; rows without a time, rows whose time stands
still, and single rows out of place are left out or put in order.  A clock that runs backwards
otherwise is an error: nothing could tell which part of the file is right.
"""

import numpy as np

from spirob.errors import DataError

WRAPS = (2.0**16, 2.0**32)  # counts after which a counter begins again
NEAR = 0.05  # of a wrap by which the step back may be short
MISPLACED = 0.01  # of the rows may be out of place
LONGEST = 9.2e18  # nanoseconds that an int64 holds
GAP = 5  # median periods that are told as a gap


def increasing(
    where: str, stamps: np.ndarray, factor: float, notes: list[str]
) -> tuple[np.ndarray, np.ndarray]:
    """Rows to use, in order, and their time [ns]; `factor` is seconds a unit of the stamps.

    Raises DataError where time runs backwards or is no time.
    """
    rows = np.flatnonzero(np.isfinite(stamps))
    if len(rows) < len(stamps):
        notes.append(f"{where}: {len(stamps) - len(rows)} rows without a time left out")
    if len(rows) < 2:
        raise DataError(f"{where}: fewer than two rows have a time")
    values = _unwrapped(where, stamps[rows], notes)
    back = int(np.count_nonzero(np.diff(values) < 0))
    if back:
        if back > MISPLACED * len(values):
            at = int(rows[1:][np.diff(values) < 0][0])
            raise DataError(f"{where}: time runs backwards {back} times, first at row {at}")
        order = np.argsort(values, kind="stable")
        rows, values = rows[order], values[order]
        notes.append(f"{where}: {back} rows out of place put in order of time")
    scale = factor * 1e9
    if float(np.abs(values).max()) * scale > LONGEST:
        raise DataError(f"{where}: time reaches beyond what nanoseconds can hold; check its unit")
    whole = np.rint(values * scale).astype(np.int64)  # since 1970 a float64 is good to 256 ns
    keep = np.concatenate([np.diff(whole) > 0, [True]])
    if not keep.all():
        count = int(np.count_nonzero(~keep))
        notes.append(f"{where}: {count} rows left out that share their time with the next")
        rows, whole = rows[keep], whole[keep]
    _tell_gaps(where, whole, notes)
    return rows, whole


def _unwrapped(where: str, values: np.ndarray, notes: list[str]) -> np.ndarray:
    step = np.diff(values)
    for wrap in WRAPS:
        if values.min() < 0 or values.max() >= wrap:
            continue
        wraps = step < -(1 - NEAR) * wrap
        if wraps.any() and np.all(step[~wraps] >= -NEAR * wrap):
            notes.append(f"{where}: the clock wrapped {int(wraps.sum())} times and is continued")
            return values + wrap * np.concatenate([[0], np.cumsum(wraps)])
    return values


def _tell_gaps(where: str, time_ns: np.ndarray, notes: list[str]) -> None:
    step = np.diff(time_ns)
    if len(step) < 2:
        return
    gaps = step > GAP * np.median(step)
    if gaps.any():
        notes.append(
            f"{where}: {int(gaps.sum())} gaps in time, the longest {1e-9 * step.max():.3g} s; kept"
        )
