"""Is this log fit to be judged?  A clear refusal, or a repair that is said aloud.

Every function takes and returns plain arrays; what it changed it appends to `said`, and what it
cannot repair it raises as DataError.  A diagnosis from bad data would be believed like any other.
"""

import numpy as np

from spirob.errors import DataError, TooShort

SHORTEST = 1.0  # s
FEWEST = 100  # samples
FEW = 0.01  # share of a log that may be repaired
SLOWEST, FASTEST = 20.0, 1e6  # Hz, of a usable log
GAP = 5.5  # sample periods without a sample that are still bridged
REGISTERS = (16, 32)  # bits
COUNTS = 50  # different whole numbers without a fraction: counts, not radians or metres


def regular_time(
    where: str, seconds: np.ndarray, columns: dict[str, np.ndarray], said: list[str]
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Strictly increasing finite time; a few rows that break it are dropped."""
    good = np.isfinite(seconds)
    latest = np.maximum.accumulate(np.where(good, seconds, -np.inf))
    good[1:] &= seconds[1:] > latest[:-1]
    bad = int(np.count_nonzero(~good))
    if bad > max(3, FEW * len(seconds)):
        first = int(np.flatnonzero(~good)[0])
        raise DataError(
            f"{where}: time does not increase in {bad} of {len(seconds)} rows, first in row "
            f"{first + 1}; is it another column, or are two logs joined?"
        )
    if bad:
        said.append(f"{where}: {bad} rows whose time does not increase were dropped.")
    seconds = seconds[good]
    columns = {name: values[good] for name, values in columns.items()}
    if len(seconds) < FEWEST:
        raise TooShort(where, len(seconds), FEWEST, "a diagnosis")
    if seconds[-1] - seconds[0] < SHORTEST:
        raise DataError(
            f"{where}: {seconds[-1] - seconds[0]:.3g} s long, a trial needs at least "
            f"{SHORTEST:g} s; is the unit of time right?"
        )
    rate = 1.0 / float(np.median(np.diff(seconds)))
    if not SLOWEST <= rate <= FASTEST:
        raise DataError(
            f"{where}: {rate:.3g} samples a second; between {SLOWEST:g} and {FASTEST:g} can be "
            "used; is the unit of time right?"
        )
    return seconds - seconds[0], columns


def finite(where: str, name: str, values: np.ndarray, said: list[str]) -> np.ndarray:
    """No NaN or infinity; a few are bridged."""
    bad = ~np.isfinite(values)
    count = int(np.count_nonzero(bad))
    if count == 0:
        return values
    if count > FEW * len(values):
        raise DataError(
            f"{where}: column '{name}' has no number in {count} of {len(values)} rows; "
            f"more than {FEW:.0%} cannot be bridged"
        )
    said.append(f"{where}: {count} missing values of '{name}' were bridged by a straight line.")
    index = np.arange(len(values))
    return np.interp(index, index[~bad], values[~bad])


def signed(where: str, name: str, raw: np.ndarray, said: list[str]) -> np.ndarray:
    """A register of 16 or 32 bits that was read as unsigned: what is near its top is negative."""
    for bits in REGISTERS:
        quarter = 2 ** (bits - 2)
        low, high = raw < quarter, raw >= 3 * quarter
        whole = np.all(raw == np.round(raw)) and raw.min() >= 0 and raw.max() < 4 * quarter
        if whole and np.all(low | high) and low.any() and high.any():
            said.append(
                f"{where}: '{name}' holds negative numbers of {bits} bits as {3 * quarter} and "
                "more; read as negative."
            )
            return raw - 4.0 * quarter * high
    return raw


def enough(where: str, used: float, lost: str = "") -> None:
    """Raise where rows that are compared last for less than a trial needs.

    used  [s];  lost  what was left out, where that is known
    """
    if used < SHORTEST:
        why = f" ({lost})" if lost else ""
        raise DataError(f"{where}: only {used:.2g} s are left after the row filters{why}")


def moving(where: str, name: str, values: np.ndarray) -> None:
    """Raise where a channel never changes."""
    if np.ptp(values) <= 1e-12 * max(1e-300, float(np.max(np.abs(values)))):
        raise DataError(
            f"{where}: column '{name}' is constant at {values[0]:g}; nothing can be told from it"
        )


def position(
    where: str,
    name: str,
    values: np.ndarray,
    raw: np.ndarray,
    seconds: np.ndarray,
    said: list[str],
) -> np.ndarray:
    """A position without wraps, and in the unit that it claims; raw is as logged."""
    steps = np.diff(values)
    apart = np.diff(seconds)
    steps[apart > GAP * np.median(apart)] = 0.0  # across a gap anything may have happened
    usual = np.quantile(np.abs(steps), 0.98)
    span = float(np.ptp(values))
    large = _alone(steps, span)
    if not large.any():
        _not_counts(where, name, values, raw)
        return values
    sizes = np.abs(steps[large])
    if len(sizes) <= FEW * len(values):
        healed = _without_spikes(values, large)
        if healed is not None:
            said.append(f"{where}: {int(large.sum())} jumps of '{name}' out and back were bridged.")
            return healed
    wrap = float(np.median(sizes))
    if np.all(np.abs(sizes - wrap) < 0.05 * wrap + 4 * usual) and wrap > 0.8 * span:
        period = _period(steps, large)
        said.append(
            f"{where}: '{name}' wraps round by {period:.4g}; unwrapped at {len(sizes)} places."
        )
        turns = np.concatenate([[0], np.cumsum(np.where(large, -np.sign(steps), 0.0))])
        return position(where, name, values + turns * period, raw, seconds, said)
    at = int(np.flatnonzero(large)[0])
    raise DataError(
        f"{where}: '{name}' jumps by {sizes[0]:.3g} in row {at + 2}, where {usual:.2g} is usual: "
        "lost counts, an encoder's reset, or a wrong unit"
    )


def _alone(steps: np.ndarray, span: float) -> np.ndarray:
    """Steps that their neighbours know nothing of: a motor is fast for more than one sample.

    A jump by J is off the mean of its neighbours by J, and throws each of them off by -J/2; the
    start of a fast motion throws off one of them only.
    """
    padded = np.pad(steps, 1, mode="edge")
    off = steps - 0.5 * (padded[:-2] + padded[2:])
    beside = np.pad(off, 1)
    large = np.abs(off) > max(8.0 * float(np.quantile(np.abs(off), 0.98)), 0.01 * span)
    return np.asarray(large & (np.abs(beside[:-2] + off + beside[2:]) < 0.4 * np.abs(off)))


def _period(steps: np.ndarray, large: np.ndarray) -> float:
    # a wrap is a whole period less the way travelled in that sample; taken from the steps beside
    usual = np.interp(np.arange(len(steps)), np.flatnonzero(~large), steps[~large])
    return float(np.median(np.abs((steps - usual)[large])))


def _without_spikes(values: np.ndarray, large: np.ndarray) -> np.ndarray | None:
    """The signal with single samples that jump out and back bridged; None where that is not it."""
    bad = np.zeros(len(values), bool)
    bad[1:-1] = large[:-1] & large[1:]
    index = np.arange(len(values))
    healed = np.interp(index, index[~bad], values[~bad])
    return None if _alone(np.diff(healed), float(np.ptp(healed))).any() else healed


def _not_counts(where: str, name: str, values: np.ndarray, raw: np.ndarray) -> None:
    """`raw` is the column before its factor: whole numbers that no factor scales are counts."""
    scaled = abs(np.ptp(values) / np.ptp(raw) - 1.0) > 1e-6
    if not scaled and np.all(raw == np.round(raw)) and len(np.unique(raw)) > COUNTS:
        raise DataError(
            f"{where}: '{name}' holds whole numbers only, {raw.min():g} to {raw.max():g}: "
            "these are counts; give their size as 'factor'"
        )


def velocity(where: str, name: str, given: np.ndarray, derived: np.ndarray) -> None:
    """Raise where a measured velocity is not the derivative of the position."""
    size = float(np.sqrt(np.mean(derived**2)))
    slope = float(np.dot(given, derived) / np.dot(derived, derived))
    correlation = float(np.corrcoef(given, derived)[0, 1])
    if size > 0 and (correlation < 0.8 or not 0.8 < slope < 1.25):
        raise DataError(
            f"{where}: '{name}' is {slope:.3g} times the derivative of the position (correlation "
            f"{correlation:.2f}); a wrong unit, sign or column"
        )


def regular_grid(
    where: str, seconds: np.ndarray, columns: dict[str, np.ndarray], said: list[str]
) -> tuple[float, list[dict[str, np.ndarray]]]:
    """The sample period, and the columns on even grids, one for each piece between gaps.

    Each piece has its own `time`.  Pieces shorter than half a second are dropped.
    """
    steps = np.diff(seconds)
    period = float(np.median(steps))
    cuts = np.flatnonzero(steps > GAP * period) + 1
    pieces, lost = [], 0.0
    for rows in np.split(np.arange(len(seconds)), cuts):
        length = seconds[rows[-1]] - seconds[rows[0]]
        if length < 0.5 * SHORTEST:
            lost += length
            continue
        even = np.arange(seconds[rows[0]], seconds[rows[-1]] + 0.5 * period, period)
        piece = {n: np.interp(even, seconds[rows], v[rows]) for n, v in columns.items()}
        pieces.append({**piece, "time": even})
    if len(cuts):
        gap = steps[cuts - 1].max()
        said.append(
            f"{where}: {len(cuts)} gaps, the longest {gap:.3g} s; the log was cut there into "
            f"{len(pieces)} pieces" + (f", and {lost:.2g} s of scraps dropped." if lost else ".")
        )
    uneven = float(np.max(np.abs(steps[steps <= GAP * period] / period - 1.0)))
    if uneven > 0.2:
        said.append(f"{where}: samples are uneven by up to {uneven:.0%}; put on an even grid.")
    if sum(p["time"][-1] - p["time"][0] for p in pieces) < SHORTEST:
        raise DataError(f"{where}: gaps leave less than {SHORTEST:g} s of it")
    return period, pieces
