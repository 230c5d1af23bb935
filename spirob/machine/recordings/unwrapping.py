"""A position that begins again goes on, as the axis did.

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
ANOTHER = "its zero may be another there, which moves what depends on position"
FASTEST, LEAP = 0.98, 1.5  # of the rows of a log; how much faster it never moves
SMOOTHER = 0.5  # of the squared changes of speed: another modulus explains the motion better
SLOWEST, QUARTER = 0.05, 0.25  # of the rows, and of a modulus a row


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
        """Change of the value over a period, (n - 1,); across gaps that of the rows beside.

        Of rows closer than a period it is their way: a jump between them is no larger for that.
        """
        found = np.diff(self.values) * self.period / np.maximum(self.apart, self.period)
        index, far = np.arange(len(found)), self.apart > self.longest
        return np.where(far, np.interp(index, index[~far], found[~far]), found)

    def fastest(self) -> float:
        """What the axis moves a period at most; infinite where no two rows are near."""
        near = self.apart <= self.longest
        rates = np.abs(self.rates()[near])
        return LEAP * float(np.quantile(rates, FASTEST)) if len(rates) else np.inf

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
    # steps of a few counts agree with one another whatever they are
    count = float(np.diff(np.unique(track.values)).min())
    return size if len(sizes) > 1 and count < WITHIN * size else None


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


def without_wraps(
    where: str, name: str, track: Track, modulus: float, said: list[str]
) -> tuple[Track, int]:
    """The track unwrapped, and at how many places; what of it is no more than a guess is told.

    Raises DataError where the position exceeds a modulus that was given.
    """
    values, wraps, fast = unwrapped(track, modulus)
    if track.modulus is not None:
        said += _contradicted(where, name, track, modulus, wraps)
    track = replace(track, values=values)
    if wraps:
        how = " by its speed, as it turns by half and more in a row" if fast else ""
        said.append(
            f"{where}: '{name}' wraps round by {modulus:.4g}; unwrapped at {wraps} places{how}."
        )
        said += _unsure(where, name, track, modulus)
        said += _guessed(where, name, track, modulus)
    return track, wraps


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


def _guessed(where: str, name: str, track: Track, modulus: float) -> list[str]:
    """That over some gaps the axis, as fast as elsewhere, can have turned by half a modulus."""
    way = track.fastest() * track.apart / track.period
    wide = track.apart[(track.apart > track.longest) & (way > 0.5 * modulus)]
    if not len(wide):
        return []
    gaps = "a gap" if len(wide) == 1 else f"{len(wide)} gaps, the longest"
    return [
        f"{where}: how often '{name}' wrapped round over {gaps} of {wide.max():.3g} s is a guess: "
        f"{ANOTHER}."
    ]
