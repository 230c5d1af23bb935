"""The measured motion of all trials in a row, and what the body asks for on it.

A `Way` is what effects remember along, from one piece of a log to the next.  Through a gap a memory
takes up a straight line from the signals before it to those behind it: heat, bristles and lags go
on, as they do in the machine.  Only with a log does memory begin anew.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from spirob.machine.inverse.body import RigidBody
from spirob.machine.recordings.filtering import earlier, rates
from spirob.machine.recordings.recording import Piece, Recording

IN_GAP = 1000  # rows at most; a longer gap is gone through in longer steps
CYCLE = 1e-3  # s, of the bus for which effects on its frames are written
REACH = 4  # samples to either side that a second derivative looks at
NEEDS = ("load", "payload", "along", "across")  # of `RigidBody.needs`


@dataclass(frozen=True)
class Way:
    """The rows that a memory takes up one after the other: m, of which n are the motion's.

    starts (parts + 1,), steps (parts,), anew (parts,)  as `kernel_loop.loop_of` says
    before, behind  (m,) rows of the motion that a row lies between
    share  (m,) of the way from the one to the other;  rows  (n,) those that are the motion's
    """

    starts: np.ndarray
    steps: np.ndarray
    anew: np.ndarray
    before: np.ndarray
    behind: np.ndarray
    share: np.ndarray
    rows: np.ndarray

    def over(self, values: np.ndarray) -> np.ndarray:
        """Values at the rows of a motion, (k, n), along this way, (k, m)."""
        if len(self.rows) == len(self.share):
            return values
        here, there = values[:, self.before], values[:, self.behind]
        return np.asarray(here + self.share * (there - here))


def apart(starts: np.ndarray, steps: np.ndarray) -> Way:
    """The way of a memory that begins anew with every piece."""
    rows = np.arange(starts[-1])
    return Way(starts, steps, np.ones(len(steps), bool), rows, rows, np.zeros(len(rows)), rows)


def bridged(
    starts: np.ndarray, steps: np.ndarray, seconds: np.ndarray, follows: Sequence[bool]
) -> Way:
    """The way of a memory that goes on through the gaps; arguments as in `motion.Motion`."""
    before, behind, share, ends, paces, anew = [], [], [], [0], [], []

    def part(from_rows: np.ndarray, to_rows: np.ndarray, shares: np.ndarray, step: float) -> None:
        before.append(from_rows)
        behind.append(to_rows)
        share.append(shares)
        ends.append(ends[-1] + len(shares))
        paces.append(step)

    for k, step in enumerate(steps):
        begin, end = starts[k], starts[k + 1]
        if follows[k]:
            # pieces that adjoin after a cut may overlap by part of a row, each on a grid of its own
            gap = max(float(seconds[begin] - seconds[begin - 1]), float(step))
            count = int(np.clip(round(gap / step) - 1, 1, IN_GAP))
            rows = np.full(count, begin)
            part(rows - 1, rows, np.arange(1, count + 1) / (count + 1), gap / (count + 1))
            anew.append(False)
        rows = np.arange(begin, end)
        part(rows, rows, np.zeros(len(rows)), step)
        anew.append(not follows[k])
    shares = np.concatenate(share)
    return Way(
        np.array(ends),
        np.array(paces),
        np.array(anew),
        np.concatenate(before),
        np.concatenate(behind),
        shares,
        np.flatnonzero(shares == 0.0),
    )


@dataclass(frozen=True)
class Motion:
    """The signals of all pieces in a row, each (n,), and what the body asks for along them.

    starts  (pieces + 1,) where each piece begins and ends;  steps  (pieces,) sample periods [s]
    logs    (pieces,) names of the logs that they are of
    follows (pieces,) whether a piece goes on after a gap in the one before; empty where none does
    """

    starts: np.ndarray
    steps: np.ndarray
    seconds: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    effort: np.ndarray
    body: dict[str, np.ndarray]
    logs: tuple[str, ...] = ()
    follows: tuple[bool, ...] = ()

    @cached_property
    def apart(self) -> Way:
        """The way of a memory that begins anew with every piece."""
        return apart(self.starts, self.steps)

    @cached_property
    def bridged(self) -> Way:
        """The way of a memory that goes on through the gaps of a log."""
        if not any(self.follows):
            return self.apart
        return bridged(self.starts, self.steps, self.seconds, self.follows)

    @cached_property
    def turned(self) -> tuple[np.ndarray, np.ndarray]:
        """Cosine and sine of the position of an axis that turns, (n,) each."""
        return np.cos(self.q), np.sin(self.q)

    def rates(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First and second derivative of a signal by time, none across pieces, (n,) each."""
        first, second = np.empty_like(values), np.empty_like(values)
        for k, step in enumerate(self.steps):
            rows = slice(self.starts[k], self.starts[k + 1])
            first[rows], second[rows] = rates(values[rows], step)
        return first, second

    def spread(self, values: np.ndarray) -> np.ndarray:
        """One value a piece, (pieces,), at each of its samples, (n,)."""
        return np.repeat(values, np.diff(self.starts))

    def dealt(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The samples at the pace of a bus: their order (n,), where rows begin, and their steps.

        A log may be faster than any bus: its samples are then dealt out to as many rows.
        """
        stride = max(1, round(CYCLE / float(np.min(self.steps))))
        pieces = zip(self.starts[:-1], self.starts[1:], strict=True)
        rows = [np.arange(a + k, b, stride) for a, b in pieces for k in range(stride)]
        starts = np.cumsum([0, *(len(row) for row in rows)])
        return np.concatenate(rows), starts, np.repeat(stride * self.steps, stride)

    def without(self, error: np.ndarray) -> "Motion":
        """The motion with an error of its sensor taken out."""
        fast, faster = self.rates(error)
        return replace(self, q=self.q - error, v=self.v - fast, a=self.a - faster)


def motion_of(recordings: Sequence[Recording], body: RigidBody | None, mass: float) -> Motion:
    """The motion of all pieces; `mass` is the payload that the body's needs are given for [kg]."""
    pieces = [(r, p) for r in recordings for p in r.pieces]
    needs = []
    for _, piece in pieces:
        nothing = {name: np.zeros(len(piece.q)) for name in NEEDS}
        needs.append(body.needs(piece, mass) if body else nothing)

    def along(field: str) -> np.ndarray:
        return np.concatenate([getattr(p, field) for _, p in pieces])

    return Motion(
        np.cumsum([0, *(len(p.q) for _, p in pieces)]),
        np.array([r.period for r, _ in pieces]),
        along("seconds"),
        along("q"),
        along("v"),
        along("a"),
        along("effort"),
        {name: np.concatenate([n[name] for n in needs]) for name in NEEDS},
        tuple(r.log or r.name for r, _ in pieces),
        tuple(piece is not r.pieces[0] for r, piece in pieces),
    )


@dataclass(frozen=True)
class Kept:
    """The rows of one piece that are compared: `inside` it, and `along` all pieces in a row."""

    recording: Recording
    piece: Piece
    inside: np.ndarray
    along: np.ndarray


def kept_rows(recordings: Sequence[Recording]) -> Iterator[Kept]:
    """What is left of each piece after thinning and the row filters."""
    begin = 0
    for recording in recordings:
        for piece in recording.pieces:
            inside = np.arange(0, len(piece.q), recording.every)
            inside = inside[piece.use[inside]]
            yield Kept(recording, piece, inside, begin + inside)
            begin += len(piece.q)


def late(effort: np.ndarray, delay: float, motion: Motion) -> np.ndarray:
    """e(t - δ): whole samples by moving rows, the rest, half a sample at most, to second order."""
    if delay == 0.0:
        return effort
    out = np.empty_like(effort)
    for k, step in enumerate(motion.steps):
        whole = round(delay / step)
        rest = delay - whole * step
        rows = slice(motion.starts[k], motion.starts[k + 1])
        _shift(_moved(effort[rows], rest, step), whole, out[rows])
    return out


def _shift(values: np.ndarray, by: int, out: np.ndarray) -> None:
    """Values (n,) by so many rows later; the first or the last one stands where none is."""
    n = len(values)
    by = max(-n, min(by, n))
    first, end = max(by, 0), min(n, n + by)
    out[:first], out[end:] = values[0], values[-1]
    out[first:end] = values[first - by : end - by]


def _moved(values: np.ndarray, by: float, period: float) -> np.ndarray:
    """Values (n,) as they were `by` seconds earlier, to second order.

    Away from the ends, where derivatives are one-sided, this is one filter of a few taps.
    """
    if len(values) <= 6 * REACH:
        return earlier(values, by, period)
    out = np.convolve(values, _taps(by, period), "same")
    out[:REACH] = earlier(values[: 3 * REACH], by, period)[:REACH]
    out[-REACH:] = earlier(values[-3 * REACH :], by, period)[-REACH:]
    return out


@lru_cache(maxsize=64)  # the derivatives of a fit move the delay once, and all else many times
def _taps(by: float, period: float) -> np.ndarray:
    impulse = earlier(np.eye(1, 4 * REACH + 1, 2 * REACH)[0], by, period)
    return impulse[REACH : 3 * REACH + 1]
