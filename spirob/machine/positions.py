"""A position as the axis moved: what begins again goes on, and what jumps is told.

A position that begins again after a turn, or after as much as its number holds, is unwrapped: a
wrapped step is the true one less a whole modulus.  The true one is less than half a modulus, or it
continues the speed before; what a sensor's speed says tells turns that no row shows.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.ndimage import median_filter

from spirob.errors import DataError

LARGE = 0.5  # of the span: a step that no motion makes in one row
RARE = 0.005  # of the values may be spikes at either end
FULL = 0.9  # of the modulus that the values span at least
ALIKE = 0.75  # of the large steps say the same modulus, within
WITHIN = 0.05  # of it
SNAP = 2e-3  # of a usual modulus: what is so near is meant to be it
LONG = 1.5  # periods between two rows: samples are lost between
SLOW = 0.01  # moduli a row: what is slower stands
JUMPS = 6  # and spikes, that may hide a modulus
TURNS = 4  # whole turns a row that are looked for at most, either way
FEW, LEAST = 0.01, 10  # share of a log that may be jumps, and how many at least
SINGLE = 0.05  # share of it that may be spikes: what they hide stands beside them
UNUSUAL = ((0.98, 8.0), (0.9, 30.0))  # so many times what such a share of the rows does at most
BACK = 0.2  # of a spike by which the position may have moved on behind it
ANOTHER = "its zero may be another there, which moves what depends on position"
LEAP = 1.5  # times the fastest 2 % of the log
SURELY = 6.0  # times what is usual: a change of speed, and a speed that is none of its noise
SMOOTHER = 0.5  # of the squared changes of speed: another modulus explains the motion better
SLOWEST, QUARTER = 0.05, 0.25  # of the rows, and of a modulus a row
SEEN = 0.01  # of the span: smaller spikes and jumps are left alone


@dataclass(frozen=True)
class Track:
    """A position as it was logged, one finite value a row.

    values   (n,);  seconds  (n,)
    period   of the samples [s];  longest  seconds without a row after which anything may follow
    usual    moduli that are known in the unit of the values, such as a turn
    modulus  where it is known;  speed  (n,) by a sensor of its own, up to a factor, where there is
    """

    values: np.ndarray
    seconds: np.ndarray
    period: float
    longest: float
    usual: Sequence[float] = ()
    modulus: float | None = None
    speed: np.ndarray | None = None

    @property
    def apart(self) -> np.ndarray:
        """Seconds from each row to the next, (n - 1,)."""
        return np.diff(self.seconds)

    def rates(self) -> np.ndarray:
        """Change of the value over a period, (n - 1,); across gaps that of the rows beside."""
        found = np.diff(self.values) * self.period / self.apart
        index, far = np.arange(len(found)), self.apart > self.longest
        return np.where(far, np.interp(index, index[~far], found[~far]), found)

    def without(self, rows: np.ndarray) -> "Track":
        """The track without some rows, a mask (n,)."""
        speed = None if self.speed is None else self.speed[~rows]
        return replace(self, values=self.values[~rows], seconds=self.seconds[~rows], speed=speed)


def modulus_of(track: Track) -> float | None:
    """The modulus of a position that wraps round; None where it does not.

    A row that wraps differs from its neighbours by a whole modulus, at any speed.  A jump beyond it
    hides that, so parts between the largest steps are looked at, too.
    """
    if track.modulus is not None:
        return track.modulus
    rows = np.arange(len(track.values))
    largest = np.argsort(-np.abs(np.diff(track.values)))[:JUMPS] + 1
    for count in range(len(largest) + 1):
        ends = [0, *sorted(largest[:count].tolist()), len(rows)]
        begin, end = max(pairwise(ends), key=lambda part: part[1] - part[0])
        if found := _modulus(track.without((rows < begin) | (rows >= end))):
            return found
    return None


def _modulus(track: Track) -> float | None:
    steps = np.diff(track.values)[track.apart <= LONG * track.period]
    low, high = np.quantile(track.values, [RARE, 1 - RARE])
    large = np.abs(steps) > LARGE * (high - low)
    back = large[1:] & large[:-1] & (steps[1:] * steps[:-1] < 0)  # a spike, or on the edge
    wraps = large & ~np.append(back, False) & ~np.insert(back, 0, False)
    small = np.flatnonzero(~large)
    moved = np.count_nonzero(steps[small])  # at rest, two counts in turn are no wraps
    if not wraps.any() or moved <= np.count_nonzero(wraps):
        return None
    beside = np.interp(np.arange(len(steps)), small, steps[small])
    sizes = np.abs(steps - beside)[wraps]
    size = float(np.median(sizes))
    rough = 4.0 * float(np.median(np.abs(np.diff(steps[small]))))
    alike = np.mean(np.abs(sizes - size) < WITHIN * size + rough) >= ALIKE
    spans = high - low, float(np.ptp(track.values))
    if (
        rough > size
        or not alike
        or not any(FULL * size - rough <= span <= size / FULL for span in spans)
    ):
        return None
    for known in track.usual:
        if abs(size - known) < SNAP * known + rough:
            return float(known)
    return size if len(sizes) > 1 else None


def unwrapped(track: Track, modulus: float) -> tuple[np.ndarray, int, bool]:
    """The values without wraps, (n,), how many there were, and whether some row turned by half."""
    steps = np.diff(track.values)
    near = steps - modulus * np.rint(steps / modulus)
    true, fast = _continued(track, near, modulus)
    wraps = int(np.count_nonzero(np.rint((true - steps) / modulus)))
    return np.concatenate([track.values[:1], track.values[0] + np.cumsum(true)]), wraps, fast


def _continued(track: Track, near: np.ndarray, modulus: float) -> tuple[np.ndarray, bool]:
    """Steps of one speed after another, (n - 1,), from the shortest that each could be."""
    apart, period = track.apart, track.period
    known = np.flatnonzero(apart <= LONG * period)
    if len(known) < 2:
        return near, False
    rates = near[known] * period / apart[known]
    smooth = np.unwrap(rates, period=modulus)
    fast = bool(np.abs(np.diff(rates)).max() > 0.5 * modulus)
    fast = fast and bool(np.abs(np.diff(smooth)).max() < 0.5 * np.abs(np.diff(rates)).max())
    if fast or track.speed is not None:
        smooth = smooth if fast else rates
        turns = _turns(track, known, smooth, modulus)
        fast = fast or turns != 0
        rates = smooth + turns * modulus
    middle = track.seconds[:-1] + 0.5 * apart
    expected = np.interp(middle, middle[known], rates) * apart / period
    # where rows are lost, the shortest way is not the likeliest
    expected[known] = rates * apart[known] / period
    return near + modulus * np.rint((expected - near) / modulus), fast


def _turns(track: Track, known: np.ndarray, rates: np.ndarray, modulus: float) -> int:
    """Whole moduli a row that all rates lack: by the sensor of speed, else with the most rest."""
    many = np.arange(-TURNS, TURNS + 1)
    if track.speed is None:
        speeds = np.abs(rates / modulus + many[:, None])
        return int(many[int(np.argmin(np.log(speeds + SLOW).mean(axis=1)))])
    told = 0.5 * (track.speed[:-1] + track.speed[1:])[known]
    good = np.isfinite(told)
    told = told[good]
    power = float(np.dot(told, told))
    if power == 0.0:
        return 0
    missed = []
    for k in many:
        tried = rates[good] + k * modulus
        left = tried - told * (np.dot(tried, told) / power)
        missed.append(float(np.dot(left, left) / max(np.dot(tried, tried), 1e-300)))
    best = int(many[int(np.argmin(missed))])
    return best if min(missed) < 0.5 * missed[TURNS] else 0


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
        values, wraps, fast = unwrapped(track, modulus)
        if track.modulus is not None:
            said += _contradicted(where, name, track, modulus, wraps)
        if wraps:
            how = " by its speed, as it turns by half and more in a row" if fast else ""
            said.append(
                f"{where}: '{name}' wraps round by {modulus:.4g}; unwrapped at {wraps} places{how}."
            )
        track = replace(track, values=values)
        said += _unsure(where, name, track, modulus) if wraps else []
    jumps, track = _jumps(where, name, track, said)
    kept = np.flatnonzero(~spikes)
    values = np.interp(np.arange(len(spikes)), kept, track.values)
    return Repaired(values, kept[jumps], modulus if wraps else None)


def _contradicted(where: str, name: str, track: Track, modulus: float, wraps: int) -> list[str]:
    """That a position which never wraps exceeds the modulus that is given for it.

    Raises DataError where it wraps and spans more, or where another modulus that its own steps
    tell leaves a motion so much smoother.
    """
    unit = "is that of another unit than the column's?"
    found = modulus_of(replace(track, modulus=None))
    if found is not None and abs(found - modulus) > WITHIN * modulus:
        rough, given = (
            float(np.sum(np.diff(unwrapped(track, m)[0], 2) ** 2)) for m in (found, modulus)
        )
        if rough < SMOOTHER * given:
            raise DataError(
                f"{where}: '{name}' begins again after {found:.4g} by its own steps, not after its "
                f"modulus of {modulus:.4g}: {unit}"
            )
    low, high = np.quantile(track.values, [RARE, 1.0 - RARE])
    if high - low <= (1.0 + WITHIN) * modulus:
        return []
    said = f"{where}: '{name}' spans {high - low:.4g}, more than its modulus of {modulus:.4g}"
    if wraps:
        raise DataError(f"{said}: {unit}")
    return [f"{said}, and never begins again: used as it is."]


def _unsure(where: str, name: str, track: Track, modulus: float) -> list[str]:
    """That the other way round would do as well, and no sensor of speed tells.

    It would where no row is slow, or where the speed changes at once, as the way is told by the
    speed before.  From a quarter of the modulus a row on, the other way is less than three times
    as fast, or as large a change.
    """
    rates = track.rates() / modulus
    slow = float(np.quantile(np.abs(rates), SLOWEST))
    change = float(np.abs(np.diff(median_filter(rates, 5))).max())  # and stays so: a jump does not
    if track.speed is not None or max(slow, change) < QUARTER:
        return []
    moves = f"moves on by {slow:.2g} of its modulus a row and more, and never rests"
    if slow < QUARTER:
        moves = f"changes its speed by {change:.2g} of its modulus a row from one row to the next"
    return [
        f"{where}: '{name}' {moves}: whether that way round or the other, nothing tells. Give a "
        "velocity, or log more often."
    ]


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


def _jumps(where: str, name: str, track: Track, said: list[str]) -> tuple[np.ndarray, Track]:
    """Rows before which the position jumps, (k,), and the track without those jumps that are told.

    Where the axis moves on at its speed, the step is that of the zero, and is taken out.  Where it
    stands, nobody knows whether it was moved meanwhile.
    """
    rates = track.rates()
    _leaps(where, name, track, rates, said)
    at = np.flatnonzero(_alone(rates, track.values))
    if not len(at):
        return at, track
    before, after = rates[np.maximum(at - 1, 0)], rates[np.minimum(at + 1, len(rates) - 1)]
    step = np.diff(track.values)[at]
    told = (
        f"{where}: '{name}' jumps by {step[0]:.3g} at {track.seconds[at[0] + 1]:.4g} s, where it "
        f"moves by {before[0]:.2g} in the row before and {after[0]:.2g} in the row behind"
    )
    if len(at) > max(LEAST, FEW * len(rates)):
        raise DataError(f"{told}, and {len(at)} times in all: lost counts, or a wrong unit?")
    more = f" and {len(at) - 1} times more" if len(at) > 1 else ""
    moving = _goes_on(rates, before, after) & (track.apart[at] <= LONG * track.period)
    leaps = np.zeros_like(track.values)
    leaps[at[moving] + 1] = (step - 0.5 * (before + after))[moving]
    ends = "its motion goes on behind it" if moving.all() else ANOTHER
    said.append(f"{told}{more}: lost counts or a reset; the log was cut there, and {ends}.")
    return at + 1, replace(track, values=track.values - np.cumsum(leaps))


def _leaps(where: str, name: str, track: Track, rates: np.ndarray, said: list[str]) -> None:
    """Say where the position changes over a gap faster than anywhere else."""
    steps, far = np.diff(track.values) * track.period / track.apart, track.apart > track.longest
    fastest = float(np.quantile(np.abs(rates[~far]), UNUSUAL[0][0])) if not far.all() else np.inf
    if len(at := np.flatnonzero(far & (np.abs(steps) > LEAP * fastest))):
        change, length = np.diff(track.values)[at[0]], track.apart[at[0]]
        said.append(
            f"{where}: '{name}' changes by {abs(change):.3g} over a gap of {length:.3g} s, faster "
            f"than it moves elsewhere: {ANOTHER}."
        )


def _goes_on(rates: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Whether the axis moves at one speed before and after each of some jumps, (k,)."""
    usual, rough = (float(np.median(np.abs(np.diff(rates, k)))) for k in (1, 2))
    alike = np.abs(after - before) <= SURELY * usual
    moves = np.minimum(np.abs(before), np.abs(after)) > SURELY * rough
    return np.asarray(alike & moves)


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
