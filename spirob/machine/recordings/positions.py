"""A position as the axis moved: wraps, single false rows and jumps are taken out, and told."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import median_filter

from spirob.errors import DataError
from spirob.machine.recordings.unwrapping import (
    ANOTHER,
    FULL,
    LONG,
    Track,
    modulus_of,
    without_wraps,
)

FEW, LEAST = 0.01, 10  # share of a log that may be jumps, and how many at least
SINGLE = 0.05  # share of it that may be spikes: what they hide stands beside them
UNUSUAL = ((0.98, 8.0), (0.9, 30.0))  # so many times what such a share of the rows does at most
BACK = 0.2  # of a spike by which the position may have moved on behind it
SURELY = 6.0  # times what is usual: a change of speed, and a speed that is none of its noise
LACKING, WHOLE = 4, 0.15  # rows that may lack without a stamp that tells, and how near to whole
HALF, FEWEST = 0.5, 3  # of a row's way, or of the rows; rows that tell a speed
STOOD, NEAR = 0.25, 0.25  # of the speed before: that stands; of a stall's rows, so near as many
COUNTS = "lost counts or a reset"
SEEN = 0.01  # of the span: smaller spikes and jumps are left alone


@dataclass(frozen=True)
class Repaired:
    """A position without wraps and spikes, (n,), and the rows before which it jumps, (k,).

    modulus  by which it wrapped; None where it did not
    """

    values: np.ndarray
    jumps: np.ndarray
    modulus: float | None


def repaired(where: str, name: str, track: Track, said: list[str]) -> Repaired:
    """The motion behind a logged position.

    Raises DataError where it jumps too often to be one.
    """
    modulus = modulus_of(track)
    spikes = _spikes(track, modulus)
    if spikes.any():
        said.append(f"{where}: {int(spikes.sum())} jumps of '{name}' out and back were bridged.")
        track = track.without(spikes)
    wraps = 0
    if modulus is not None:
        track, wraps = without_wraps(where, name, track, modulus, said)
    stalled, kept = _stalled(track), np.flatnonzero(~spikes)
    if stalled.any():
        said.append(
            f"{where}: '{name}' moves by the way of some rows in one and then stands for as many, "
            f"{int(stalled.sum())} rows in all: the logger stalled; they were bridged."
        )
        track, kept = track.without(stalled), kept[~stalled]
    jumps, track = _jumps(where, name, track, said)
    values = np.interp(np.arange(len(spikes)), kept, track.values)
    return Repaired(values, kept[jumps], modulus if wraps else None)


def _spikes(track: Track, modulus: float | None) -> np.ndarray:
    """Single rows that lie apart while those beside them follow one another, a mask (n,)."""

    def short(steps: np.ndarray) -> np.ndarray:
        return steps if modulus is None else steps - modulus * np.rint(steps / modulus)

    rates = short(np.diff(track.values)) * track.period / track.apart
    off = short(short(np.diff(track.values)) - median_filter(rates, 5) * track.apart / track.period)
    least = _unusual(off, track.values)
    large = np.abs(off) > least
    spikes = np.zeros(len(track.values), bool)
    back = np.abs(short(off[:-1] + off[1:])) <= np.maximum(least, BACK * np.abs(off[1:]))
    spikes[1:-1] = large[:-1] & large[1:] & back
    return spikes if spikes.sum() <= max(LEAST, SINGLE * len(spikes)) else np.zeros_like(spikes)


def _stalled(track: Track) -> np.ndarray:
    """Rows that a logger wrote behind the time of their stamps, a mask (n,).

    It reads the way of some rows in one, and then mostly the same place until the axis, at the
    speed before and behind, would be there: over all of them it is steady, as no lost counts make
    it.
    """
    rates, stalled = track.rates(), np.zeros(len(track.values), bool)
    for k in np.flatnonzero(_alone(rates, track.values)):
        speed = float(np.median(rates[max(k - FEWEST, 0) : k])) if k else 0.0
        if speed != 0.0 and (rows := _stall(rates[k:] / speed)):
            stalled[k + 1 : k + 1 + rows] = True
    return stalled


def _stall(rates: np.ndarray) -> int:
    """Rows that a stall before these, over the speed before, lasts; 0 where it is none.

    It ends where two rows in turn move once some stood.
    """
    stands = np.abs(rates) < STOOD
    stood = np.cumsum(stands[:-2]) > 0
    ends = np.flatnonzero(stood & ~stands[1:-1] & ~stands[2:])
    rows = int(ends[0]) if len(ends) else 0
    if not rows or np.mean(stands[1 : rows + 1]) < HALF or rates[rows + 1] < STOOD:
        return 0
    way = 0.5 * (1.0 + rates[rows + 1])
    ahead = float(np.sum(rates[: rows + 1])) - (rows + 1) * way
    return rows if abs(ahead) <= max(1.0, NEAR * rows) * max(way, 1.0) else 0


def _jumps(where: str, name: str, track: Track, said: list[str]) -> tuple[np.ndarray, Track]:
    """Rows before which the position jumps, (k,), and the track without those jumps that are told.

    Where the axis moves on at its speed, the step is that of the zero, and is taken out.  Where it
    stands, nobody knows whether it was moved meanwhile.
    """
    rates = track.rates()
    _leaps(where, name, track, said)
    at = np.flatnonzero(_alone(rates, track.values))
    if not len(at):
        return at, track
    found = _Jumps(
        at,
        np.diff(track.values)[at],
        rates[np.maximum(at - 1, 0)],
        rates[np.minimum(at + 1, len(rates) - 1)],
        track.seconds[at + 1],
    )
    moves, alike = _goes_on(rates, found.before, found.after)
    near = track.apart[at] <= LONG * track.period
    lost = near & moves & (alike | found.told) & found.whole_rows
    moving = near & moves & (alike | lost)
    said += _lost(where, name, found, lost)
    most = max(LEAST, FEW * len(rates))
    whole = FULL * float(np.ptp(track.values))
    said += _of_counts(where, name, found, ~lost, moving, most, whole)
    leaps = np.zeros_like(track.values)
    counts = moving & ~lost
    leaps[at[counts] + 1] = (found.step - found.way)[counts]
    return at + 1, replace(track, values=track.values - np.cumsum(leaps))


@dataclass(frozen=True)
class _Jumps:
    """Steps that their neighbours know nothing of, (k,) each.

    at  row before each;  step  of the position;  before, after  its change in the rows beside
    seconds  of the row behind
    """

    at: np.ndarray
    step: np.ndarray
    before: np.ndarray
    after: np.ndarray
    seconds: np.ndarray

    @property
    def way(self) -> np.ndarray:
        """Change in a row at the speed there."""
        return 0.5 * (self.before + self.after)

    @property
    def whole_rows(self) -> np.ndarray:
        """Which are the way of some rows at their speed: rows lack, and no counts."""
        rows = self.step / np.where(self.way == 0.0, np.inf, self.way)
        whole = np.rint(rows)
        return np.asarray((whole > 1) & (whole <= LACKING) & (np.abs(rows - whole) < WHOLE))

    @property
    def told(self) -> np.ndarray:
        """Of which the speeds before and after differ by less than one in how many rows it is."""
        return np.asarray(np.abs(self.step * (self.after - self.before)) < self.way**2)


def _lost(where: str, name: str, found: _Jumps, lost: np.ndarray) -> list[str]:
    """That samples were lost, where (k,) says so."""
    if not lost.any():
        return []
    k = int(np.argmax(lost))
    return [
        f"{where}: '{name}' moves by the way of {found.step[k] / found.way[k]:.0f} rows in one at "
        f"{found.seconds[k]:.4g} s{_more(lost)}: samples were lost that no stamp tells; the log "
        "was cut there."
    ]


def _of_counts(
    where: str,
    name: str,
    found: _Jumps,
    jumps: np.ndarray,
    moving: np.ndarray,
    most: float,
    whole: float,
) -> list[str]:
    """That the position jumps, where (k,) says so; raise DataError where it does more often.

    whole  a step from one end of what the position reaches to the other: it may begin again there
    """
    if not jumps.any():
        return []
    k = int(np.argmax(jumps))
    told = (
        f"{where}: '{name}' jumps by {found.step[k]:.3g} at {found.seconds[k]:.4g} s, where it "
        f"moves by {found.before[k]:.2g} in the row before and {found.after[k]:.2g} in the row "
        "behind"
    )
    if jumps.sum() > most:
        raise DataError(f"{told}, and {jumps.sum()} times in all: lost counts, or a wrong unit?")
    ends = "its motion goes on behind it" if moving[jumps].all() else ANOTHER
    wraps = moving[jumps].all() and np.abs(found.step[jumps]).min() > whole
    why = "it begins again after as much (position.modulus), or was reset" if wraps else COUNTS
    return [f"{told}{_more(jumps)}: {why}; the log was cut there, and {ends}."]


def _more(where: np.ndarray) -> str:
    """How often besides the first."""
    return f" and {where.sum() - 1} times more" if where.sum() > 1 else ""


def _leaps(where: str, name: str, track: Track, said: list[str]) -> None:
    """Say where the position changes over a gap faster than anywhere else."""
    steps, far = np.diff(track.values) * track.period / track.apart, track.apart > track.longest
    if len(at := np.flatnonzero(far & (np.abs(steps) > track.fastest()))):
        change, length = np.diff(track.values)[at[0]], track.apart[at[0]]
        said.append(
            f"{where}: '{name}' changes by {abs(change):.3g} over a gap of {length:.3g} s, faster "
            f"than it moves elsewhere: {ANOTHER}."
        )


def _goes_on(
    rates: np.ndarray, before: np.ndarray, after: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Whether the axis moves before and after each of some jumps, and at one speed, (k,) each."""
    usual, rough = (float(np.median(np.abs(np.diff(rates, k)))) for k in (1, 2))
    alike = np.abs(after - before) <= SURELY * usual
    moves = np.minimum(np.abs(before), np.abs(after)) > SURELY * rough
    return np.asarray(moves), np.asarray(alike)


def _alone(steps: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Steps that their neighbours know nothing of: a motor is fast for more than one sample.

    A jump by J is off the mean of its neighbours by J, and throws each of them off by -J/2; the
    start of a fast motion throws off one of them only.
    """
    padded = np.pad(steps, 1, mode="edge")
    off = steps - 0.5 * (padded[:-2] + padded[2:])
    beside = np.pad(off, 1)
    large = np.abs(off) > _unusual(off, values)
    return np.asarray(large & (np.abs(beside[:-2] + off + beside[2:]) < 0.4 * np.abs(off)))


def _unusual(off: np.ndarray, values: np.ndarray) -> float:
    """What a step has to be off its neighbours to be no motion of a position, (n,) values."""
    low, high = np.quantile(values, [0.01, 0.99])
    sizes = [times * float(np.quantile(np.abs(off), share)) for share, times in UNUSUAL]
    least = min((size for size in sizes if size > 0), default=0.0)
    return max(least, SEEN * float(high - low))
