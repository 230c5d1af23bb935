"""Is this log fit to be judged, and which of its rows?  A refusal, or a repair said aloud.

Every function takes and returns plain arrays; what it changed it appends to `said`, and what it
cannot repair it raises as DataError.  A diagnosis from bad data would be believed like any other.
"""

from collections import Counter

import numpy as np
import scipy

from spirob.errors import DataError, NothingLeft
from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.clock import SHORTEST

REGISTERS = (16, 32)  # bits
COUNTS = 50  # different whole numbers without a fraction: counts, not radians or metres
LARGEST, SMALLEST = 1e100, 1e-100  # sizes whose squares are still numbers
FEW = 100  # rows beside which a single one is judged
SINGLE = 0.05  # share of a log that may be single broken values
DIGITS = 2.0**24  # of a single-precision number: no sensor gives values as many times larger
TENFOLD = np.sqrt(10.0)  # times: nearer to ten than to one
NINES = 10.0 ** np.arange(3, 16) - 1.0  # 999 and longer, which files hold for a missing number
TEN = 10.0  # times beyond all others, for such a one


def signed(where: str, name: str, raw: np.ndarray, said: list[str]) -> np.ndarray:
    """A register of 16 or 32 bits that was read as unsigned: what is near its top is negative."""
    known = raw[np.isfinite(raw)]
    if not len(known) or np.any(known != np.round(known)) or known.min() < 0:
        return raw
    for bits in REGISTERS:
        quarter = 2 ** (bits - 2)
        low, high = known < quarter, known >= 3 * quarter
        if np.all(low | high) and low.any() and high.any() and known.max() < 4 * quarter:
            said.append(
                f"{where}: '{name}' holds negative numbers of {bits} bits as {3 * quarter} and "
                "more; read as negative."
            )
            return np.where(raw >= 3 * quarter, raw - 4.0 * quarter, raw)
    return raw


def enough(where: str, used: float, lost: str = "") -> None:
    """Raise NothingLeft where rows that are compared last for less than a trial needs.

    used  [s];  lost  what was left out, where that is known
    """
    if used < SHORTEST:
        why = f" ({lost})" if lost else ""
        left = f"only {used:.3g} s are left after the row filters, {SHORTEST:g} s are needed"
        raise NothingLeft(f"{where}: {left}{why}")


def not_constant(where: str, name: str, values: np.ndarray) -> None:
    """Raise NothingLeft where a channel never changes, DataError where it holds no sizes."""
    known = values[np.isfinite(values)]
    if not len(known):
        raise NothingLeft(f"{where}: column '{name}' has no number in any row")
    size = float(np.max(np.abs(known)))
    if size > LARGEST or 0.0 < size < SMALLEST:
        raise DataError(f"{where}: column '{name}' reaches {size:.3g}; is its factor right?")
    if np.ptp(known) <= 1e-12 * size:
        raise NothingLeft(
            f"{where}: column '{name}' is constant at {known[0]:g}; nothing can be told from it"
        )


def without_sentinels(
    where: str, name: str, values: np.ndarray, cells: np.ndarray, said: list[str]
) -> np.ndarray:
    """Values (n,), NaN in the few rows that stand for a missing number.

    They lie `DIGITS` times beyond all others, or are all nines as logged, in cells (n,), and lie
    ten times beyond.
    """
    size = np.abs(values)
    order = np.argsort(np.where(np.isfinite(size), size, -1.0))
    top = order[len(order) - int(SINGLE * len(order)) - 1 :]
    with np.errstate(over="ignore"):
        times = np.where(np.isin(np.abs(cells[top[1:]]), NINES), TEN, DIGITS)
        beyond = (size[top[1:]] > times * size[top[:-1]]) & (size[top[:-1]] > 0.0)
    if not beyond.any():
        return values
    missing = top[np.argmax(beyond) + 1 :]
    said.append(
        f"{where}: {len(missing)} values of '{name}', {size[missing].min():.3g} and more, are no "
        "sizes that the others can be told beside, and were taken as missing."
    )
    cleaned = values.copy()
    cleaned[missing] = np.nan
    return cleaned


def without_outliers(
    where: str, name: str, values: np.ndarray, period: float, said: list[str]
) -> np.ndarray:
    """Values (n,), NaN in single rows that each outweigh all others of the second around them.

    They are larger, too, than whatever lasts two rows of the log.  No motion asks for that: such a
    row is a broken message.  A second has at least `FEW` rows: a blow may last one of a slow log.
    """
    known = np.flatnonzero(np.isfinite(values))
    if len(known) < FEW:
        return values
    told = np.clip(values[known], -LARGEST, LARGEST)
    lasting = scipy.ndimage.median_filter(told, 3, mode="nearest")
    alone, weights = (told - lasting) ** 2, (told - np.median(told)) ** 2
    alone[alone <= np.max((lasting - np.median(told)) ** 2)] = 0.0
    seconds = max(1, int(len(told) / max(FEW, 1.0 / period)))
    blocks = np.array_split(np.arange(len(told)), seconds)
    broken = known[np.concatenate([b[_outweighing(alone[b], weights[b])] for b in blocks])]
    if not len(broken):
        return values
    said.append(
        f"{where}: {len(broken)} single values of '{name}', up to "
        f"{np.abs(values[broken]).max():.3g}, outweigh all beside them and were bridged."
    )
    cleaned = values.copy()
    cleaned[broken] = np.nan
    return cleaned


def _outweighing(alone: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """The few rows, (k,), that each stand out, squared, by more than the rest together weighs."""
    order = np.argsort(-alone)
    count = round(SINGLE * len(order))
    rest = np.cumsum(weights[order][::-1])[::-1]
    outweigh = np.flatnonzero(alone[order[:count]] > rest[1 : count + 1])
    return order[: outweigh[-1] + 1] if len(outweigh) else order[:0]


def not_counts(where: str, name: str, raw: np.ndarray) -> None:
    """Raise where a position as it is logged, for which no factor is given, is whole numbers."""
    raw = raw[np.isfinite(raw)]
    if np.all(raw == np.round(raw)) and len(np.unique(raw)) > COUNTS:
        raise DataError(
            f"{where}: '{name}' holds whole numbers only, {raw.min():g} to {raw.max():g}: "
            "are these counts? Give their size as 'factor' (1 where they are in that unit)"
        )


# Periods of the cutoff from an end, where acceleration as compared is good to 3 %, and to 0.1 %
EDGE, SETTLED = 2.5, 6.0
SHARE = 0.05  # of a piece that may be lost at each end for that
SHORT = 0.25  # of a period of the cutoff: bridged, what is compared is good to 2 %
STILL = 1e-3  # of a log's stroke: a piece that moves by less stands


def usable(
    full: np.ndarray,
    v: np.ndarray,
    filled: np.ndarray,
    rig: RigFile,
    period: float,
    cutoff: float,
    lost: Counter[str],
) -> np.ndarray:
    """Rows of a piece that are compared, (n,).

    full    rows in which the drive saturates;  filled  that the log does not hold
    v       filtered, in SI
    lost    gets how many rows are left out for which reason
    """
    use = np.ones(len(v), bool)
    drop = rig.filter.drop
    if drop is None:
        drop = round(min(SETTLED, max(EDGE, SHARE * len(v) * cutoff * period)) / (cutoff * period))
    use[:drop] = False
    use[max(len(use) - drop, 0) :] = False
    if rig.filter.drop and not use.any():
        lost[f", by filter.drop of {drop} at either end"] += len(use)
    unit = rig.speed_scale
    out = {
        ", where samples are lost or broken": beside_gaps(filled, cutoff * period),
        ", where the drive saturates": smeared(full, cutoff * period),
    }
    if rig.rows.minimum_speed is not None:
        out[" as too slow"] = np.abs(v) < unit * rig.rows.minimum_speed
    if rig.rows.maximum_speed is not None:
        out[" as too fast"] = np.abs(v) > unit * rig.rows.maximum_speed
    for why, rows in out.items():
        lost[why] += int(rows.sum())
        use &= ~rows
    return use


def stands(q: np.ndarray, stroke: float) -> bool:
    """Whether a piece stands, its positions being (n,), where its log has a stroke."""
    return float(np.ptp(q)) <= STILL * stroke


def widened(mask: np.ndarray, reach: int) -> np.ndarray:
    """The rows of a mask (n,) and those within `reach` of them."""
    reached = np.convolve(mask, np.ones(2 * reach + 1))
    return np.asarray(reached[reach : reach + len(mask)] > 0.5)


def smeared(mask: np.ndarray, cutoff: float) -> np.ndarray:
    """The rows of a mask (n,) and those over which a filter smears them; its cutoff per sample."""
    return widened(mask, max(1, round(0.5 / cutoff)))


def beside_gaps(filled: np.ndarray, cutoff: float) -> np.ndarray:
    """Filled rows (n,) that tell nothing, and those over which a filter smears them.

    A curve through the rows beside a gap tells what passes the last filter, where the gap is short
    beside a period of the cutoff, which is given per sample.
    """
    edges = np.flatnonzero(np.diff(np.r_[False, filled, False]))
    long = np.zeros(len(filled), bool)
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        long[start:stop] = (stop - start) * cutoff > SHORT
    return smeared(long, cutoff)
