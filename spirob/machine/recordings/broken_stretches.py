"""Stretches of a log that are broken, which is said: bursts of its effort, seconds of its position.

An effort that is none of this machine's is bridged and not compared; seconds in which most of the
position is faster than what is compared are cut out.

What plain columns of the motion make, fitted by least absolute errors, tells the effort of a good
log, whatever a fifth of it holds.  A burst is where that misses √10 times what it misses anywhere
else, and the effort is √10 times what the motion asks for: nearer to ten than to one.

A blow, a stop or a load makes such a stretch, too, but shows in the motion: it moves the axis
before a drive can hold against it.  So a burst is broken only where its motion is that of the rest,
and not where it lasts and a constant force explains it: a stiff drive may carry that unmoved, as
long as it is not ten times what the drive gives elsewhere.  At rest a brake or a stop may hold the
axis against any effort: beside that nothing is told.  Such bursts stay, and are said.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import KDTree

from spirob.errors import NothingLeft
from spirob.machine.recordings.checks import EDGE, TEN, TENFOLD, widened
from spirob.machine.recordings.filtering import derivative, rates, smooth
from spirob.machine.recordings.grids import FILLED

MOST = 0.3  # of a log that may be bursts: they are told by the rest
TOGETHER = 0.25  # s between two parts of a burst: an effort too large passes through zero, too
LONG = 1.0  # s, within which nothing tells a constant force from a part of any other
FAR = 2.0  # deviations of the rest's motion, between it and a motion that is another
LADDER = 1.15 ** -np.arange(60.0)  # of levels, over three decades
ROUNDS, SMALL = 40, 1e-6  # of weighted least squares, and the least error in its weights
ENOUGH = 20_000  # rows that are looked at
NOISE = 0.5  # of a motion's variance: more beyond what is compared is no motion
PIECE = 0.5  # s, of what is left between broken seconds
SLIDES = 0.05  # of the RMS speed: slower than that, dry friction may hold any effort
Grid = dict[str, np.ndarray]


@dataclass(frozen=True)
class Looked:
    """A log in which bursts are looked for: its name and that of its effort, how it is filtered.

    period  of its grids [s];  cutoff  [Hz];  turns  whether its position is an angle
    """

    where: str
    name: str
    period: float
    cutoff: float
    turns: bool

    @property
    def edge(self) -> int:
        """Rows at the ends of a piece where nothing is compared."""
        return round(EDGE / (self.cutoff * self.period))


@dataclass(frozen=True)
class Track:
    """Every n-th row of all pieces in a row, each array (N,).

    motion   (N, 3): position, speed, acceleration;  asked  what the plain columns make of it
    counted  rows that are compared, in motion;  rest  those of them that are in no burst
    free     rows that are not beside a rest
    piece    of which it is;  row  which of its rows
    """

    motion: np.ndarray
    effort: np.ndarray
    counted: np.ndarray
    rest: np.ndarray
    free: np.ndarray
    piece: np.ndarray
    row: np.ndarray
    asked: np.ndarray

    @property
    def missed(self) -> np.ndarray:
        """What the plain columns miss, 0 where nothing is compared."""
        return np.where(self.counted, self.effort - self.asked, 0.0)

    @property
    def most(self) -> float:
        """What they miss at most outside of the bursts."""
        return float(np.abs(self.missed[self.rest]).max())

    def beyond(self, rows: np.ndarray) -> bool:
        """Whether they miss √10 times that in some of these rows."""
        return bool(np.abs(self.missed[rows]).max(initial=0.0) > TENFOLD * self.most)


@dataclass(frozen=True)
class Burst:
    """Rows of a track, and how many times as large their effort is as the motion asks for."""

    rows: np.ndarray
    times: float


def without_bursts(log: Looked, grids: list[Grid], said: list[str]) -> list[Grid]:
    """The pieces with broken bursts bridged, their rows marked as filled."""
    track, bursts = _told(log, grids)
    for burst in bursts:
        begin, end = (grids[track.piece[k]]["time"][track.row[k]] for k in burst.rows[[0, -1]])
        what = (
            f"{log.where}: '{log.name}' is {burst.times:.2g} times as large for "
            f"{end - begin:.2g} s from {begin:.3g} s on as the same motion asks for elsewhere; "
        )
        if why := _acted(log, track, burst):
            said.append(f"{what}{why}")
            continue
        said.append(f"{what}left out, as broken.")
        grids = [_bridged(track, burst, k, grid) for k, grid in enumerate(grids)]
    return grids


def _told(log: Looked, grids: list[Grid]) -> tuple[Track, list[Burst]]:
    """The log's rows with what the motion asks for, and its bursts."""
    track = _track(log, grids)
    if np.count_nonzero(track.counted) <= 2 * log.edge:
        return track, []
    together = round(TOGETHER / (log.period * _every(log, grids)))
    columns, bursts = _columns(log, track.motion), []
    for _ in range(2):  # bursts bend the fit a little
        numbers = least_absolute(columns[track.rest], track.effort[track.rest])
        track = replace(track, asked=columns @ numbers)
        bursts = [b for rows in _beyond(track, together) if (b := _burst(track, rows))]
        rest = track.counted.copy()
        for burst in bursts:
            rest[burst.rows] = False
        track = replace(track, rest=rest)
    return track, [b for b in bursts if track.beyond(b.rows)]


def _every(log: Looked, grids: Sequence[Grid]) -> int:
    rows = sum(len(grid["time"]) for grid in grids)
    return max(1, int(1.0 / (8.0 * log.cutoff * log.period)), rows // ENOUGH)


def _track(log: Looked, grids: Sequence[Grid]) -> Track:
    motions, every, parts = [_motion(log, grid) for grid in grids], _every(log, grids), []
    slides = _slides(np.concatenate(motions)[:, 1])
    for k, (grid, motion) in enumerate(zip(grids, motions, strict=True)):
        rows = np.arange(len(motion))
        inside = (rows >= log.edge) & (rows < len(rows) - log.edge)
        moves = np.abs(motion[:, 1]) > slides
        effort = smooth(grid["effort"], log.cutoff, log.period)
        columns = (motion, effort, inside & moves, _free(log, moves), np.full(len(rows), k), rows)
        parts.append([values[::every] for values in columns])
    motion, effort, counted, free, piece, row = map(np.concatenate, zip(*parts, strict=True))
    return Track(motion, effort, counted, counted, free, piece, row, np.zeros_like(effort))


def _motion(log: Looked, grid: Grid) -> np.ndarray:
    """Position, speed and acceleration of a piece, (n, 3)."""
    q = smooth(grid["position"], log.cutoff, log.period)
    v, a = rates(q, log.period)
    if "velocity" in grid:
        v = smooth(grid["velocity"], log.cutoff, log.period)
        a = derivative(v, log.period)
    return np.column_stack([q, v, a])


def _free(log: Looked, moves: np.ndarray) -> np.ndarray:
    """Rows of a piece beside no rest; where it turns back is none, which the filter hardly sees."""
    half = round(0.5 / (log.cutoff * log.period))
    return ~widened(~widened(moves, half), half + log.edge)


def _slides(v: np.ndarray) -> float:
    return SLIDES * float(np.sqrt(np.mean(v**2))) + 1e-300


def _columns(log: Looked, motion: np.ndarray) -> np.ndarray:
    """What inertia, friction, drag, a force, a spring and a weight make of a motion, (N, k)."""
    q, v, a = motion.T
    found = [a, v, np.tanh(v / _slides(v)), v * np.abs(v), np.ones_like(v), q]
    if log.turns:
        found += [np.sin(q), np.cos(q)]
    return np.column_stack(found)


def least_absolute(columns: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Numbers of columns (N, k) that leave the least sum of absolute errors, (k,)."""
    size = np.linalg.norm(columns, axis=0) + 1e-300
    least = SMALL * float(np.mean(np.abs(values))) + 1e-300
    weights, found = np.ones(len(values)), np.zeros(len(size))
    for _ in range(ROUNDS):
        design = columns / size * weights[:, None]
        found = np.linalg.lstsq(design, weights * values, rcond=None)[0]
        errors = np.abs(values - columns / size @ found)
        weights = 1.0 / np.sqrt(np.maximum(errors, least))
    return np.asarray(found / size)


def _beyond(track: Track, together: int) -> list[np.ndarray]:
    """Rows of each stretch that goes √10 times beyond the lowest level that no other row passes."""
    missed, found = np.abs(track.missed), []
    for level in float(missed.max()) / TENFOLD * LADDER:
        beyond = np.flatnonzero(missed > level)
        parts = np.split(beyond, np.flatnonzero(np.diff(beyond) > max(1, together)) + 1)
        stretches = [np.arange(p[0], p[-1] + 1) for p in parts if len(p)]
        if sum(map(len, stretches)) > MOST * np.count_nonzero(track.counted):
            break
        if all(missed[rows].max() > TENFOLD * level for rows in stretches):
            found = stretches
    return found


def _burst(track: Track, rows: np.ndarray) -> Burst | None:
    """A stretch whose effort goes √10 times beyond what its motion asks for."""
    rows = rows[track.counted[rows]]
    if not len(rows):
        return None
    asked = float(np.abs(track.asked[rows]).max()) + 1e-300
    times = float(np.abs(track.effort[rows]).max()) / asked
    return Burst(rows, times) if times > TENFOLD else None


def _acted(log: Looked, track: Track, burst: Burst) -> str:
    """What may have acted on the axis in a burst; empty where the effort alone is another."""
    free = burst.rows[track.free[burst.rows]]
    if not track.beyond(free) or _burst(track, free) is None:
        return "it is beside a rest, in which a brake or a stop may hold the axis. It is kept."
    size = track.motion[track.rest].std(axis=0) + 1e-300
    apart = KDTree(track.motion[track.rest] / size).query(track.motion[burst.rows] / size)[0]
    if apart.max() > FAR:
        return "the axis moves as nowhere else there: a blow, a stop or a load? It is kept."
    missed, row = track.missed[burst.rows], track.row[burst.rows]
    alike = float(np.median(np.abs(missed - np.median(missed)))) < track.most
    if alike and burst.times < TEN and (row[-1] - row[0]) * log.period > LONG:
        return "a constant force would explain it: a load? It is kept."
    return ""


def _bridged(track: Track, burst: Burst, piece: int, grid: Grid) -> Grid:
    """A piece with a line for the effort of a burst and beside it, where nothing is compared."""
    own = track.row[burst.rows[track.piece[burst.rows] == piece]]
    if not len(own):
        return grid
    around = track.row[track.rest & (track.piece == piece)]
    before, after = around[around < own[0]], around[around > own[-1]]
    rows = np.arange(len(grid["time"]))
    broken = (rows > max(before, default=-1)) & (rows < min(after, default=len(rows)))
    kept = np.flatnonzero(~broken)
    effort = np.interp(rows, kept, grid["effort"][kept]) if len(kept) else grid["effort"]
    return {**grid, "effort": effort, FILLED: np.where(broken, 1.0, grid[FILLED])}


def followed(
    where: str, name: str, grids: list[Grid], edge: float, period: float, said: list[str]
) -> list[Grid]:
    """The pieces of a log without seconds in which its position is noise.

    Noise is what is faster than what is compared, `edge` [Hz], where it is more than half of the
    whole motion's variance.  Raises NothingLeft where that is most of the log.
    """
    places = [grid["position"] for grid in grids]
    rows = sum(map(len, places))
    motion = sum(float(np.sum((q - q.mean()) ** 2)) for q in places) / rows
    fast = [_means((q - smooth(q, edge, period)) ** 2, period) for q in places]
    noise = [(motion > 0.0) & (means > NOISE * motion) for means in fast]
    found, lost = _without(noise, grids, period)
    if 2 * lost > rows or not found:
        raise NothingLeft(
            f"{where}: '{name}' is no motion that can be followed: in {lost / rows:.0%} of the "
            f"log most of its variance lies above {edge:.3g} Hz; is it another column, an axis "
            "that stands, or an angle that turns too fast for these rows?"
        )
    if lost:
        said.append(
            f"{where}: '{name}' is noise, or faster than what is compared, for "
            f"{lost * period:.3g} s, which were left out."
        )
    return found


def _means(values: np.ndarray, period: float) -> np.ndarray:
    """Of each second of a piece, the last one shorter, (seconds,)."""
    blocks = _seconds(len(values), period)
    return np.asarray(np.bincount(blocks, values) / np.bincount(blocks))


def _seconds(rows: int, period: float) -> np.ndarray:
    return np.arange(rows) // max(1, round(1.0 / period))


def _without(broken: list[np.ndarray], grids: list[Grid], period: float) -> tuple[list[Grid], int]:
    """The pieces without broken seconds and those beside them, and how many rows these have."""
    found, lost = [], 0
    for grid, bad in zip(grids, broken, strict=True):
        rows = widened(bad, 1)[_seconds(len(grid["time"]), period)]
        lost += int(rows.sum())
        parts = np.split(np.arange(len(rows)), np.flatnonzero(np.diff(rows.astype(int))) + 1)
        kept = [p for p in parts if not rows[p[0]] and (not bad.any() or len(p) * period > PIECE)]
        found += [{name: values[part] for name, values in grid.items()} for part in kept]
    return found, lost
