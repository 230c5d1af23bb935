"""The time of each row of a trial, as its stamps and the smoothness of its motion tell.

Stamps may be coarse, late or in bursts, and then an even clock lies behind them; or the rows were
read at uneven times, and then they are right.  Under the right one the signals are smoother.

A logger that had no new frame may have held the one before while the axis moved on: every channel
repeats exactly.  So it does where an axis stands under an effort without noise, or where coarse
channels are the same by chance; but from rest an axis starts slowly, and by chance it moves by no
more than one count.  Behind a held frame it is at speed at once, and has caught up.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from spirob.errors import DataError, NothingLeft, TooShort
from spirob.logs.stamps import GAP, EvenClock, Ordered, even_clock, ordered

SHORTEST = 0.5  # s, over which errors are correlated: a block of them
FEWEST = 40  # samples
SLOWEST, FASTEST = 10.0, 1e6  # Hz, of a usable log
REPEATED = 0.9  # of the rows that share their stamp say nothing new: the log repeats itself
HALF = 0.5  # or such a share of the frames, more than `FEWEST`, last as many rows as one another
AGAIN = 1.0  # s put between two stretches of a clock that starts again
SMOOTHER = 0.1  # by which the signals are where it decides
SHARED = 1.1  # rows to a stamp: more is a coarse clock, fewer are slips


@dataclass(frozen=True)
class Clock:
    """Rows of a log that are used, in order.

    rows     index into the log, (n,);  seconds  since the first, (n,), strictly increasing
    period   of the samples [s];  begins  rows, counted among the used, where the clock starts again
    """

    rows: np.ndarray
    seconds: np.ndarray
    period: float
    begins: np.ndarray

    @property
    def longest(self) -> float:
        """Seconds without a sample that are still bridged."""
        return bridged(self.period)


def bridged(period: float) -> float:
    """Seconds without a sample that are bridged; motors take tens of milliseconds to move."""
    return max(GAP * period, 0.025)


def clock_of(
    where: str,
    stamps: np.ndarray,
    unit: float,
    signals: Mapping[str, np.ndarray],
    said: list[str],
) -> Clock:
    """The clock of a trial from its stamps, (N,), `unit` seconds each, and its signals, (N,) each.

    Raises DataError where the column is no time, or too slow or fast; NothingLeft and TooShort
    where the log is short.
    """
    every = ordered(where, stamps, unit, said)
    found = _without_held(where, _without_repeats(where, every, signals, said), signals, said)
    if len(found.rows) < FEWEST:
        raise TooShort(where, len(found.rows), FEWEST, "a diagnosis")
    values = unit * (found.stamps - found.stamps[0])
    parts = np.split(np.arange(len(values)), found.begins[1:])
    parts = [p for p in parts if len(np.unique(values[p])) >= 3]
    # the last row lasts as long as any other
    length = round(sum(float(np.ptp(values[p])) * len(p) / (len(p) - 1) for p in parts), 9)
    if not SHORTEST <= length < np.inf:
        raise NothingLeft(
            f"{where}: {length:.3g} s long, a trial needs at least {SHORTEST:g} s; is the unit of "
            "time right?"
        )
    places = _places(found, len(stamps) if len(every.rows) == len(found.rows) else 0)
    clocks = [even_clock(values[p], places[p]) for p in parts]
    sizes = [len(p) for p in parts]
    period = float(np.median(np.repeat([c.period for c in clocks], sizes)))
    if not SLOWEST <= 1.0 / period <= FASTEST:
        raise DataError(
            f"{where}: {1.0 / period:.3g} samples a second; between {SLOWEST:g} and {FASTEST:g} "
            "can be used; is the unit of time right?"
        )
    rows = [found.rows[p] for p in parts]
    chosen, rows = _chosen(where, clocks, rows, signals, said)
    seconds = [part - part[0] for part in chosen]
    for k in range(1, len(seconds)):
        seconds[k] += seconds[k - 1][-1] + AGAIN
    begins = np.cumsum(sizes)[:-1]
    return Clock(np.concatenate(rows), np.concatenate(seconds), period, begins)


def _places(found: Ordered, count: int) -> np.ndarray:
    """The place of each row among `count` that were logged, (n,), in the order of time.

    A row whose stamp is broken was read all the same: the rows beside it are two periods apart.
    """
    broken = np.setdiff1d(np.arange(count), found.rows)
    before = np.maximum.accumulate(np.searchsorted(broken, found.rows))
    return np.asarray(np.arange(len(found.rows)) + before)


def _without_repeats(
    where: str, found: Ordered, signals: Mapping[str, np.ndarray], said: list[str]
) -> Ordered:
    """Rows that share their stamp and hold what is in the row before were logged twice."""
    shared, still = np.diff(found.stamps) == 0, _still(found, signals)
    same = shared & still
    if not same.any() or (same.sum() < REPEATED * shared.sum() and not _regular(still)):
        return found
    said.append(f"{where}: {int(same.sum())} rows that repeat the one before were dropped.")
    return _kept(found, np.concatenate([[True], ~same]))


def _without_held(
    where: str, found: Ordered, signals: Mapping[str, np.ndarray], said: list[str]
) -> Ordered:
    """Rows that hold the frame before while the axis moves on are lost samples.

    Where most rows do, they are only if frames come at a rate of their own, not in bursts.
    """
    positions = [v[found.rows] for key, v in signals.items() if key.endswith("position")]
    still = _still(found, signals)
    dropped = held(still, positions)
    dropped[found.begins] = False
    bursts = np.mean(dropped) > HALF and not _regular(still)
    if bursts or not dropped.any():
        return found
    said.append(
        f"{where}: {int(dropped.sum())} rows hold the frame before in every column while the axis "
        "moves on; taken as lost samples."
    )
    return _kept(found, ~dropped)


def _still(found: Ordered, signals: Mapping[str, np.ndarray]) -> np.ndarray:
    """Whether every signal is as in the row before, (n - 1,)."""
    still = np.ones(len(found.rows) - 1, bool)
    for values in signals.values():
        one, two = values[found.rows[:-1]], values[found.rows[1:]]
        still &= (one == two) | (np.isnan(one) & np.isnan(two))
    return still


def _kept(found: Ordered, keep: np.ndarray) -> Ordered:
    """The rows of a mask, (n,)."""
    begins = np.cumsum(keep)[found.begins] - 1
    return Ordered(found.rows[keep], found.stamps[keep], begins)


def _regular(still: np.ndarray) -> int:
    """For how many rows at most, two or more, most frames hold, as no axis that stands; else 0.

    Frames whose rate is no whole number of rows hold for one of two numbers, one apart.
    """
    rows = np.diff(np.flatnonzero(np.concatenate([[True], ~still, [True]])))
    counts = np.bincount(rows, minlength=4)
    alike = counts[2:-1] + counts[3:]
    usual = int(np.argmax(alike))
    return usual + 3 if alike[usual] > max(HALF * len(rows), FEWEST) else 0


def _chosen(
    where: str,
    clocks: list[EvenClock],
    rows: list[np.ndarray],
    signals: Mapping[str, np.ndarray],
    said: list[str],
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Seconds and rows of each stretch: by the stamps, or even where that is smoother.

    Stamps that are not believed for the time of a row are not believed for its order either.
    """
    if all(c.even is None for c in clocks):
        return [c.given for c in clocks], rows
    even = [c.given if c.even is None else c.even for c in clocks]
    given = [_rising(c.given, c.period) for c in clocks]
    longest = max(range(len(rows)), key=lambda k: len(rows[k]))
    gain = 0.0
    for values in signals.values():
        one, two = (_roughness(t[longest], values[rows[longest]]) for t in (even, given))
        gain += np.log(two / one) if one > 0 and two > 0 else 0.0
    shared = max(c.shared for c in clocks)
    is_even = gain > (-SMOOTHER if shared > SHARED else SMOOTHER)
    moved = max(
        float(np.abs(np.diff(g - e)).max() / c.period)
        for e, g, c in zip(even, given, clocks, strict=True)
    )
    if shared > SHARED:
        how = "spread evenly" if is_even else "spread up to the next"
        said.append(
            f"{where}: the clock is coarser than the samples, {shared:.3g} rows to a stamp; rows "
            f"were {how}, {clocks[longest].period:.4g} s apart."
        )
    elif is_even:
        said.append(
            f"{where}: stamps are uneven by up to {moved:.0%} of a sample; the signals are "
            "smoother on an even clock, which was used."
        )
    else:
        said.append(f"{where}: samples are uneven by up to {moved:.0%}; put on an even grid.")
    if not is_even:
        return given, rows
    back = [_smoother_as_logged(r, signals) for r in rows]
    if any(back):
        said.append(f"{where}: rows put in order of time are smoother as logged, and stay so.")
    return even, [np.sort(r) if b else r for r, b in zip(rows, back, strict=True)]


def _smoother_as_logged(rows: np.ndarray, signals: Mapping[str, np.ndarray]) -> bool:
    """Whether rows on an even clock, (n,), are smoother in the order in which they were logged.

    Asked where the stamps put some elsewhere, about these and the rows beside.
    """
    logged = np.sort(rows)
    near = np.flatnonzero(np.convolve(rows != logged, np.ones(3), "same")[1:-1]) + 1
    gain = 0.0
    for values in signals.values():
        one, two = (np.abs(np.diff(values[r], 2))[near - 1] for r in (logged, rows))
        good = np.isfinite(one) & np.isfinite(two)
        left, right = np.sum(one[good]), np.sum(two[good])
        gain += np.log(right / left) if left > 0 and right > 0 else 0.0
    return bool(gain > 0.0)


def _rising(seconds: np.ndarray, period: float) -> np.ndarray:
    """Times that rise by a thousandth of a period at least."""
    least = 1e-3 * period * np.arange(len(seconds))
    return np.asarray(np.maximum.accumulate(seconds - least) + least)


def _roughness(seconds: np.ndarray, values: np.ndarray) -> float:
    """By how much a row is off the cubic through the two rows before and the two behind it.

    Counted is what noise makes as large on any clock, where the signal is not at rest: the weights
    of the four rows grow the more uneven they are, and five rows alike say nothing of time.
    """
    good = np.isfinite(values)
    t, y = seconds[good], values[good]
    if len(t) < 5:
        return 0.0
    n = len(t) - 4
    near = [(t[k : k + n], y[k : k + n]) for k in (0, 1, 3, 4)]
    at, off, squares = t[2:-2], y[2:-2].copy(), np.ones(n)
    moves = np.zeros(n, bool)
    for k, (time, value) in enumerate(near):
        others = [other for j, (other, _) in enumerate(near) if j != k]
        weight = np.prod([(at - o) / (time - o) for o in others], axis=0)
        off, squares = off - weight * value, squares + weight**2
        moves |= value != y[2:-2]
    return float(np.median(np.abs(off[moves]) / np.sqrt(squares[moves]))) if moves.any() else 0.0


CAUGHT = 0.4  # of the way at the speed beside, to be moved over a held frame; from rest a quarter
BESIDE = 2  # fresh rows on either side that tell that speed
COUNT = 1.5  # times the smallest step: it moved, or was held, by more than one count
MOST = 0.5  # of the runs that end in motion are held frames; of the moving rows, or of all


def held(still: np.ndarray, positions: Iterable[np.ndarray]) -> np.ndarray:
    """Rows that hold the frame before while the axis moves, a mask (n,).

    still      (n - 1,): every channel is as in the row before;  positions  (n,) each
    """
    dropped = np.zeros(len(still) + 1, bool)
    fresh = np.flatnonzero(np.append(True, ~still))
    if still.any() and len(fresh) > 2 * BESIDE:
        alike = _regular(still)
        for values in positions:
            dropped |= _held(values, fresh, alike)
    return dropped


def of_a_register(values: np.ndarray) -> np.ndarray:
    """Rows (n,) in which a position repeats that of a register slower than the log, while it moves.

    What else the log holds may be faster.  None where the frames are not alike, as no register's,
    or most move by a count, as those of a coarse encoder.
    """
    steps, none = np.diff(values), np.zeros(len(values), bool)
    sizes = np.abs(steps[np.isfinite(steps) & (steps != 0)])
    if not len(sizes) or np.median(sizes) <= COUNT * sizes.min() or not _regular(steps == 0):
        return none
    dropped = held(steps == 0, [values])
    return dropped if np.mean(dropped) > HALF else none


def _held(values: np.ndarray, fresh: np.ndarray, alike: int) -> np.ndarray:
    """The same as one position tells it; fresh are the rows with a frame of their own.

    Over frames of up to so many rows that are alike, the motion may turn round: no axis stands for
    as long again and again, and is elsewhere a row later.

    Where most rows of the motion are held, the log is that of a slower clock: repeats go, and of a
    stand, which is longer than any hold, as many rows stay as that clock has.  A repeat over which
    the axis, at its speed beside, moves by no more than a count says nothing: a coarse encoder does
    the same.
    """
    many = np.diff(np.append(fresh, len(values)))
    steps = np.append(np.diff(values[fresh]), 0.0)
    count, usual = _count(steps), _beside(steps / many)
    moves = np.abs(steps) > COUNT * count
    ends = moves & (many > 1)
    missed = np.abs(usual) * (many - 1) > COUNT * count
    caught = ends & missed & ((many <= alike) | _goes_on(steps / many, usual))
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


def _beside(rates: np.ndarray) -> np.ndarray:
    """What is usual for the fresh rows beside each, (n,)."""
    count = len(rates)
    padded = np.pad(rates, BESIDE, mode="edge")
    places = [k for k in range(2 * BESIDE + 1) if k != BESIDE]
    return np.asarray(np.median([padded[k : k + count] for k in places], axis=0))


def _goes_on(rates: np.ndarray, usual: np.ndarray) -> np.ndarray:
    """Whether each rate is the usual one, neither a rest nor a jump, (n,)."""
    ratio = np.divide(rates, usual, out=np.zeros(len(rates)), where=usual != 0)
    return np.asarray((ratio >= CAUGHT) & (ratio <= 1.0 / CAUGHT))
