"""A position as the axis moved, and a sensor's speed beside its derivative."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import median_filter

from spirob.errors import DataError
from spirob.machine.unwrapping import LONG, RARE, WITHIN, Track, modulus_of, unwrapped

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


ALIKE = 0.8  # correlation below which it is no derivative of the position
LATE = 0.1  # s by which it may be late, and is looked for
SURELY_SHIFTED = 0.5  # of what is missed: a shift that takes less is none
NEAR = 0.03  # of 1: a scale this close is a right one


@dataclass(frozen=True)
class Agreement:
    """How a speed follows from the motion: scale times it, `late` samples later.

    alike  correlation when it is scaled and shifted
    """

    scale: float
    late: float
    alike: float


def agreement(
    given: Sequence[np.ndarray], derived: Sequence[np.ndarray], period: float
) -> Agreement | None:
    """What a given speed has to do with the derived one, over all pieces, equal lengths each.

    None where nothing moves, or it is no derivative of the position within a tenth of a second.
    """
    most = min(max(2, round(LATE / period)), min(map(len, given)) // 4)
    shifts = np.arange(-most, most + 1)
    alike = np.array([_alike(given, derived, int(k)) for k in shifts])
    best, late = int(np.argmax(np.abs(alike))), 0.0
    if 1 - alike[best] ** 2 >= SURELY_SHIFTED * (1 - alike[most] ** 2):
        best = most
    elif 0 < best < len(shifts) - 1:
        left, middle, right = np.abs(alike[best - 1 : best + 2])
        late = float(shifts[best] + 0.5 * (left - right) / (left - 2 * middle + right))
    else:
        return None
    at = alike[best]
    if not abs(at) >= ALIKE:
        return None
    one, two, both = _powers(given, derived, int(shifts[best]))
    low, high = both / two, one / both  # noise in the derivative, in the sensor
    sure = low > 0 and low * (1 - NEAR) <= 1.0 <= high * (1 + NEAR)
    return Agreement(1.0 if sure else float(np.sign(at) * np.sqrt(low * high)), late, float(at))


def shifted(values: np.ndarray, samples: float) -> np.ndarray:
    """A signal as it is so many samples later, same length; its end is held."""
    index = np.arange(len(values))
    return np.interp(index + samples, index, values)


def _powers(
    given: Sequence[np.ndarray], derived: Sequence[np.ndarray], shift: int
) -> tuple[float, float, float]:
    """Mean squares of both, and of their product, `given` taken so many samples later."""
    pairs = [(a[max(shift, 0) :], b[max(-shift, 0) :]) for a, b in zip(given, derived, strict=True)]
    one = np.concatenate([a[: len(b)] for a, b in pairs])
    two = np.concatenate([b[: len(a)] for a, b in pairs])
    return float(np.mean(one**2)), float(np.mean(two**2)), float(np.mean(one * two))


def _alike(given: Sequence[np.ndarray], derived: Sequence[np.ndarray], shift: int) -> float:
    one, two, both = _powers(given, derived, shift)
    return both / float(np.sqrt(one * two)) if one > 0 and two > 0 else 0.0
