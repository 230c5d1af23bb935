"""Effort and motion on one clock: the delay between them, how large it may be, what exceeds it.

A controller holds its effort for a cycle, a drive answers one cycle later, channels are logged one
after the other: no log is aligned to better than a sample.  A filter, a bus or a logger may delay a
channel by tens of milliseconds besides.  Not fitted, that is friction, a lag, an elastic gear or an
efficiency to whatever effect is free to follow it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from spirob.machine.models import Model
from spirob.machine.recording import Piece, Recording
from spirob.machine.rig import Bounded, RigFile

# So far apart two channels of one log may be: a sample for the effort held over a cycle, one for
# the drive's answer, one for the order of logging; of a slow log the last alone
ROWS, FEW = 3.2, 1.5
LEAST, LONG = 1e-3, 0.02  # s: always possible, and beyond which it takes a slow log
FARTHEST = 0.06  # s; public logs of real machines hold 16 to 50 ms
FINE = 4  # steps of the search in the delay that is usual
TOLD = 0.1  # of the squared error: a delay beyond the usual takes more than that
ENOUGH = 20_000  # rows to look for it
# of the delay by which a time acts there
SIGNS = {"sensing.current": 1.0, "sensing.report": 1.0, "sensing.frame": -1.0}


def usual(period: float) -> float:
    """Seconds by which effort and motion of any log may be apart, for its sample period."""
    return max(min(ROWS * period, LONG), FEW * period, LEAST)


def with_delay(
    rig: RigFile, train: Sequence[Recording], test: Sequence[Recording], rest_speed: float
) -> tuple[RigFile, list[Recording], list[Recording]]:
    """The rig with a delay between effort and motion to fit, where the description names none.

    Its bounds reach to where effort and motion lie best over one another, and as far beyond as any
    log may be off.  Rows that such a delay leaves no partner, at the ends of pieces, are not
    compared.
    """
    known, fitted = rig.known.get("delay"), rig.fit.get("delay")
    if known is None and fitted is None:
        most = usual(max(r.period for r in train))
        far = delay_beyond(train, most, rest_speed, rig.position is not None)
        fitted = Bounded(nominal=far, low=min(far, 0.0) - most, high=max(far, 0.0) + most)
        rig = rig.model_copy(update={"fit": {**rig.fit, "delay": fitted}})
    farthest = abs(known or 0.0) if fitted is None else max(fitted.high, -fitted.low)
    cut, held = ([inside(r, farthest) for r in logs] for logs in (train, test))
    if all(r.pieces for r in [*cut, *held]):
        return rig, cut, held
    return rig, list(train), list(test)


def as_usual(rig: RigFile, period: float) -> RigFile | None:
    """The rig with the usual delay alone to fit, None where no other was possible."""
    delay, most = rig.fit.get("delay"), usual(period)
    if delay is None or max(delay.high, -delay.low) <= most:
        return None
    near = Bounded(nominal=0.0, low=max(delay.low, -most), high=min(delay.high, most))
    return rig.model_copy(update={"fit": {**rig.fit, "delay": near}})


def is_far(model: Model, period: float) -> bool:
    """Whether a model needs a delay that is not usual."""
    return bool(abs(model.fit.changes["rig.delay"]) > usual(period))


def delay_beyond(
    recordings: Sequence[Recording], most: float, rest_speed: float, with_position: bool
) -> float:
    """Seconds by which the effort seems to trail the motion, 0 where that is less than `most`.

    argmin over δ of |e(t + δ) - A·x|², the columns of A being acceleration, speed, its sign, one,
    and of the position itself, sine and cosine: what any axis does to first order.
    """
    pieces = [(p, r.period) for r in recordings for p in r.pieces]
    step = max(*(period for _, period in pieces), most / FINE)
    tried = step * np.arange(-int(FARTHEST / step), int(FARTHEST / step) + 1)
    columns, efforts = [], []
    stride = max(1, sum(len(p.q) for p, _ in pieces) // ENOUGH)
    for piece, period in pieces:
        shifts = np.rint(tried / period).astype(int)
        rows = np.flatnonzero(piece.use)[::stride]
        rows = rows[(rows + shifts[0] >= 0) & (rows + shifts[-1] < len(piece.q))]
        columns.append(_columns(piece, rows, rest_speed, with_position))
        efforts.append(piece.effort[rows[:, None] + shifts])
    design, effort = np.concatenate(columns), np.concatenate(efforts)
    if len(design) <= design.shape[1]:
        return 0.0
    basis = np.linalg.qr(design / (np.linalg.norm(design, axis=0) + 1e-300))[0]
    errors = np.sum(effort**2, axis=0) - np.sum((basis.T @ effort) ** 2, axis=0)
    best, near = int(np.argmin(errors)), float(np.min(errors[np.abs(tried) <= most]))
    within = 0 < best < len(tried) - 1
    return float(tried[best]) if within and errors[best] < (1.0 - TOLD) * near else 0.0


def inside(recording: Recording, delay: float) -> Recording:
    """The trial without the rows that a delay of this size, either way, leaves no partner."""
    ends = round(delay / recording.period)
    cut = [replace(p, use=p.use & _within(len(p.q), ends)) for p in recording.pieces]
    return replace(recording, pieces=recording.worth(cut))


def only_aligns(model: Model, rig: RigFile, period: float) -> bool:
    """Whether a lag or latency of a model is no more than logs are apart anyway.

    Against a delay of the other sign it does nothing but smooth, and whatever smooths a model of
    noisy motion fits better.
    """
    if "delay" not in rig.fit:
        return False
    most, delay = min(rig.fit["delay"].high, usual(period)), model.fit.changes["rig.delay"]
    for effect in model.effects:
        times = [f for f in effect.neutral if effect.parameters()[f].unit == "s"]
        for field in times if effect.port in SIGNS else ():
            age = model.fit.changes[f"{effect.name()}.{field}"]
            if age + SIGNS[effect.port] * delay <= most:
                return True
    return False


def _within(n: int, ends: int) -> np.ndarray:
    at = np.arange(n)
    return (at >= ends) & (at < n - ends)


def _columns(piece: Piece, rows: np.ndarray, rest_speed: float, with_position: bool) -> np.ndarray:
    q, v, a = piece.q[rows], piece.v[rows], piece.a[rows]
    told = [a, v, np.tanh(v / rest_speed), np.ones_like(v)]
    return np.column_stack([*told, *([q, np.sin(q), np.cos(q)] if with_position else [])])
