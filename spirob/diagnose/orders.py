"""The orders of a ripple: how many waves a turn of the rotor the residual holds.

A ripple's kernel is linear in its amplitudes but not in its orders, so these are looked for where
the other numbers begin: at each order of a grid the residual is regressed on sine and cosine of the
rotor's angle, separately for each motor, beside the columns of the fitted numbers.  The waves pass
the residual's filter, too: the teeth of a motor pass at hundreds of hertz and show only where it
turns round.  Of two orders each is found beside the waves of the other.
"""

from collections.abc import Callable, Sequence

import numpy as np

from spirob.identify.problem import Problem, Stretch

LOWEST, HIGHEST = 0.03, 50.0  # waves a turn
RATIO = 1.03  # of neighbours in the grid
FINER = 8  # steps to a neighbour, round the best
WAVES = 0.4  # of the order's least: so many over the whole way, or it is a slope

Columns = Callable[[float], np.ndarray]


def best_orders(
    problem: Problem, residual: np.ndarray, slopes: np.ndarray, by_load: bool, count: int = 1
) -> list[float]:
    """The orders that explain most of the residual, strongest first; none without an angle.

    slopes   derivatives of the residual by the fitted numbers, (N, n)
    by_load  the wave grows with the effort, as a ripple of the torque constant does
    """
    pieces, rows = problem.stretches(), problem.rows
    angles = [p.angle for p in pieces if p.angle is not None]
    if len(angles) < len(pieces):
        return []
    way = max(float(np.ptp(a)) for a in angles) / (2 * np.pi)
    columns = _filtered(problem, pieces, angles, by_load)
    grid = np.exp(np.arange(np.log(max(LOWEST, WAVES / way)), np.log(HIGHEST), np.log(RATIO)))
    waves = {float(n): columns(n) for n in grid}
    found: dict[int, float] = {}
    for place in list(range(count)) * (1 if count == 1 else 2):
        others = [n for k, n in found.items() if k != place]
        known = np.column_stack([slopes[rows], *(columns(n) for n in others)])
        free = {n: w for n, w in waves.items() if _apart(n, others, way)}
        if free:
            best = _strongest(residual[rows], known, free)
            near = best * RATIO ** (np.arange(1 - FINER, FINER) / FINER)
            found[place] = _strongest(residual[rows], known, {float(n): columns(n) for n in near})
    return list(found.values())


def _apart(order: float, others: Sequence[float], way: float) -> bool:
    """Whether the stroke tells this order from the others: a neighbour is the same wave."""
    return all(abs(order - other) * way > 2 * WAVES for other in others)


def _filtered(
    problem: Problem, pieces: Sequence[Stretch], angles: Sequence[np.ndarray], by_load: bool
) -> Columns:
    """What gives the waves of an order as the residual sees them, (N, 2·motors)."""
    names = sorted({p.channel for p in pieces})
    fine = []
    for piece, coarse, raw in zip(pieces, angles, problem.raw(), strict=True):
        every = round(len(raw) / len(piece.seconds))
        samples = np.arange(len(raw)) / every
        steps = np.arange(len(piece.seconds))
        angle = np.interp(samples, steps, coarse)
        weight = np.interp(samples, steps, piece.effort) if by_load else np.ones(len(raw))
        fine.append((names.index(piece.channel), angle, weight, every))

    def columns(order: float) -> np.ndarray:
        parts = []
        for motor, angle, weight, every in fine:
            waves = (np.sin(order * angle) * weight, np.cos(order * angle) * weight)
            own = np.column_stack([problem.filter(w)[::every] for w in waves])
            part = np.zeros((len(own), 2 * len(names)))
            part[:, 2 * motor : 2 * motor + 2] = own
            parts.append(part)
        return np.concatenate(parts)

    return columns


def _strongest(residual: np.ndarray, known: np.ndarray, waves: dict[float, np.ndarray]) -> float:
    """The order whose waves explain most of the residual beside the known columns."""
    basis, _ = np.linalg.qr(known)
    left = residual - basis @ (basis.T @ residual)
    gains = []
    for columns in waves.values():
        own, _ = np.linalg.qr(columns - basis @ (basis.T @ columns))
        gains.append(float(np.sum((own.T @ left) ** 2)))
    return list(waves)[int(np.argmax(gains))]
