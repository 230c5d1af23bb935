"""The orders of a residual: waves that come round with a turn of the motor or of its gear's output.

    r = a sin Nθ + b cos Nθ + rest,      θ the angle of the motor, or that of the output, θ/G

Each order of a grid is regressed on (where the way is so long that a grid would be too large, the
peaks of the spectra); every motor has a and b of its own.  The best is the one that explains most
with the a and b of the motor's other trials.  Any residual of a few swings holds
waves: one counts where it explains more than any does of the same residual shifted in time, which
has the same swings at other angles.  It is taken away before the next is found.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spirob.diagnosis.orders import peaks
from spirob.identify.problem import Stretch

HIGHEST = 50.0  # periods a turn of the motor
STEP = 0.02  # to the next order of the grid, relative
PHASE = 0.1  # periods over the whole way by which neighbours differ at most
LEAST = 0.02  # of the squared error: less is not worth a line
SHIFTS = 19  # of the residual in time: what chance would find, once in twenty
RIDGE = 1e-9  # of a square's trace
FINEST = 2000  # orders in a grid


@dataclass(frozen=True)
class Order:
    """A wave in the residual.

    of     "motor", "output" or "stroke": the turns over which it is counted
    order  periods in one of these turns
    share_of_error  of the squared residual that it explains beside the stronger ones
    """

    of: str
    order: float
    share_of_error: float


def orders(pieces: Sequence[Stretch], values: np.ndarray, count: int = 4) -> list[Order]:
    """The waves that come again, the strongest first, `count` at most.

    A wave slower than one a turn of the motor is counted over the turns of the output.  None is
    looked for that does not come round once on the way, and none where no angle is known.

    values  the residual along the pieces, (N,)
    """
    if not pieces or any(p.angle is None for p in pieces):
        return []
    angle = np.concatenate([np.asarray(p.angle) for p in pieces])
    motors = _motors(pieces)
    way = max(float(np.ptp(angle[np.concatenate(t)])) for t in motors) / (2 * np.pi)
    if way == 0.0:
        return []
    gear, turn = pieces[0].gear or 1.0, pieces[0].turn
    low, high = max(1.0 / gear, 1.0 / way), _finest(pieces)
    grid = _grid(low, high, way)
    total = float(np.sum(values**2)) or 1.0
    left = values - _means(values, motors)
    found: list[Order] = []
    while len(grid) and len(found) < count:
        shifted = _shifted(left, motors)
        if len(grid) >= FINEST:
            grid = _peaked(angle, shifted, motors, low, high)
        own, foretold = _explained(angle, shifted, motors, grid)
        best = int(np.argmax(foretold[:, 0]))
        share = float(own[best, 0]) / total
        if share < LEAST or foretold[best, 0] <= foretold[:, 1:].max():
            break
        order = float(grid[best])
        turns = (turn, order) if order >= 1.0 else ("output", order * gear)
        found.append(Order(*turns, share))
        for rows in map(np.concatenate, motors):
            columns = _columns(angle[rows], order)
            left[rows] -= columns @ np.linalg.lstsq(columns, left[rows], rcond=None)[0]
    return sorted(found, key=lambda wave: -wave.share_of_error)


def _means(values: np.ndarray, motors: Sequence[Sequence[np.ndarray]]) -> np.ndarray:
    """The mean of each motor's residual, along it, (N,)."""
    out = np.empty_like(values)
    for rows in map(np.concatenate, motors):
        out[rows] = values[rows].mean()
    return out


def _shifted(left: np.ndarray, motors: Sequence[Sequence[np.ndarray]]) -> np.ndarray:
    """The residual, then what it would be later or earlier in each trial, (N, 1 + SHIFTS)."""
    out = np.repeat(left[:, None], 1 + SHIFTS, axis=1)
    for rows in (rows for trials in motors for rows in trials):
        for k in range(1, 1 + SHIFTS):
            out[rows, k] = np.roll(left[rows], k * len(rows) // (1 + SHIFTS))
    return out


def _explained(
    angle: np.ndarray, left: np.ndarray, motors: Sequence[Sequence[np.ndarray]], grid: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Squared residual that waves explain, with their own numbers and with those of other trials.

    left  (N, K) residuals;  both results (orders, K)
    """
    own = np.zeros((len(grid), left.shape[1]))
    others = np.zeros_like(own)
    for trials in motors:
        both = [_products(angle[rows], left[rows], grid) for rows in trials]
        squares, seen = (np.array(each) for each in zip(*both, strict=True))
        whole, told = squares.sum(axis=0), seen.sum(axis=0)
        explained = np.sum(told * (_inverse(whole) @ told), axis=1)
        own += explained
        if len(trials) == 1:  # there is no other trial to ask
            others += explained
            continue
        for square, here in zip(squares, seen, strict=True):
            foreign = _inverse(whole - square) @ (told - here)
            others += np.sum(foreign * (2 * here - square @ foreign), axis=1)
    return own, others


def _products(
    angle: np.ndarray, left: np.ndarray, grid: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Of each order's sine and cosine with one another and with the residuals."""
    rows = np.ascontiguousarray(left.T)  # long rows: a product goes through memory once
    squares, seen = [], []
    for order in grid:
        waves = _columns(angle, order).T
        squares.append(waves @ waves.T)
        seen.append(waves @ rows.T)
    return np.array(squares), np.array(seen)


def _inverse(square: np.ndarray) -> np.ndarray:
    # a trial that stands still tells nothing of a wave: its square has no inverse of its own
    least = RIDGE * np.trace(square, axis1=-2, axis2=-1)[:, None, None]
    return np.asarray(np.linalg.inv(square + least * np.eye(2)))


def _columns(angle: np.ndarray, order: float) -> np.ndarray:
    phase = order * angle
    return np.array([np.sin(phase), np.cos(phase)]).T


def _motors(pieces: Sequence[Stretch]) -> list[list[np.ndarray]]:
    """Rows of the residual, motor by motor and trial by trial."""
    edges = np.cumsum([0, *(len(p.seconds) for p in pieces)])
    found: dict[str, dict[str, list[np.ndarray]]] = {}
    for piece, begin, end in zip(pieces, edges[:-1], edges[1:], strict=True):
        rows = found.setdefault(piece.channel, {}).setdefault(piece.trial, [])
        rows.append(np.arange(begin, end))
    return [[np.concatenate(rows) for rows in trials.values()] for trials in found.values()]


def _grid(low: float, high: float, way: float) -> np.ndarray:
    """Orders from low to below high where the motor makes `way` turns."""
    grid = [low]
    while (further := grid[-1] + min(STEP * grid[-1], PHASE / way)) < high and len(grid) < FINEST:
        grid.append(further)
    return np.array(grid) if low < high else np.zeros(0)


def _peaked(
    angle: np.ndarray,
    left: np.ndarray,
    motors: Sequence[Sequence[np.ndarray]],
    low: float,
    high: float,
) -> np.ndarray:
    """The peaks of all residuals (N, K), and orders beside them, as spectra are coarser than grids.

    The residuals that are shifted in time get the same choice as the residual itself.
    """
    found = set()
    for rows in map(np.concatenate, motors):
        beside = PHASE * 2 * np.pi / max(float(np.ptp(angle[rows])), 1e-9)
        for column in left[rows].T:
            for order in peaks(column, angle[rows], low, high):
                found |= {order - beside, order, order + beside}
    return np.array(sorted(order for order in found if low <= order <= high))


def _finest(pieces: Sequence[Stretch]) -> float:
    """The order of which a typical moving sample still sees two points a period."""
    steps = np.concatenate([np.abs(np.diff(np.asarray(p.angle))) for p in pieces])
    moving = np.concatenate([np.abs(p.velocity[1:]) > p.still for p in pieces])
    typical = float(np.median(steps[moving])) if moving.any() else np.inf
    return min(HIGHEST, np.pi / max(typical, 1e-9))
