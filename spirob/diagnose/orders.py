"""The orders of a ripple: how many waves a turn of the rotor the residual holds.

A ripple's kernel is linear in its amplitudes but not in its orders, so these are looked for where
the other numbers begin: at each order of a fine grid the residual is regressed on sine and cosine
of the rotor's angle, separately for each motor, beside the columns of the fitted numbers.  Of two
orders each is found beside the waves of the other.
"""

from collections.abc import Sequence

import numpy as np

from spirob.identify.problem import Problem, Stretch

Wave = tuple[float, np.ndarray]  # its order, its columns
LOWEST, HIGHEST = 0.03, 50.0  # waves a turn
RATIO = 1.05  # of neighbours in the grid, at most
STEP = 0.25  # waves over the longest way between neighbours, at most
WAVES = 0.4  # of the order's least: so many over the whole way, or it is a slope
FASTEST = 0.5  # waves a sample of the residual, most of the time


def best_orders(
    problem: Problem, residual: np.ndarray, slopes: np.ndarray, by_load: bool, count: int = 1
) -> list[float]:
    """The orders that explain most of the residual, strongest first; none without an angle.

    slopes   derivatives of the residual by the fitted numbers, (N, n)
    by_load  the wave grows with the effort, as a ripple of the torque constant does
    """
    pieces = problem.stretches()
    if any(p.angle is None for p in pieces):
        return []
    rows = problem.rows
    angle = np.concatenate([p.angle for p in pieces if p.angle is not None])
    weight = np.concatenate([p.effort for p in pieces]) if by_load else np.ones(len(angle))
    motors = _motors(pieces)
    way = max(float(np.ptp(p.angle)) for p in pieces if p.angle is not None) / (2 * np.pi)
    pace = float(np.quantile(np.abs(np.diff(angle)), 0.8)) / (2 * np.pi)
    waves = [(n, _waves(n * angle, weight, motors)) for n in _grid(way, pace)]
    found: dict[int, float] = {}
    for place in list(range(count)) * (1 if count == 1 else 2):
        others = [n for k, n in found.items() if k != place]
        free = [(n, w) for n, w in waves if all(abs(n - o) * way > 2 * WAVES for o in others)]
        if free:
            known = np.column_stack([slopes[rows], *(w for n, w in waves if n in others)])
            found[place] = _strongest(residual[rows], known, free)
    return list(found.values())


def _grid(way: float, pace: float) -> np.ndarray:
    """Orders from the least that is no slope up to the fastest that the samples resolve."""
    order = max(LOWEST, WAVES / max(way, 1e-9))
    orders = []
    while order < HIGHEST and order * pace < FASTEST:
        orders.append(order)
        order += min((RATIO - 1.0) * order, STEP / way)
    return np.array(orders)


def _motors(pieces: Sequence[Stretch]) -> np.ndarray:
    """Which motor each sample belongs to, (N, motors) of zeros and ones."""
    names = sorted({p.channel for p in pieces})
    of = np.concatenate([np.full(len(p.seconds), names.index(p.channel)) for p in pieces])
    return np.asarray(of[:, None] == np.arange(len(names)), dtype=float)


def _waves(phase: np.ndarray, weight: np.ndarray, motors: np.ndarray) -> np.ndarray:
    """Sine and cosine of each motor, (N, 2·motors)."""
    waves = (np.sin(phase) * weight, np.cos(phase) * weight)
    return np.column_stack([w * of for w in waves for of in motors.T])


def _strongest(residual: np.ndarray, known: np.ndarray, waves: list[Wave]) -> float:
    """The order whose wave explains most of the residual beside the known columns."""
    basis, _ = np.linalg.qr(known)
    left = residual - basis @ (basis.T @ residual)
    gains = []
    for _, columns in waves:
        own, _ = np.linalg.qr(columns - basis @ (basis.T @ columns))
        gains.append(float(np.sum((own.T @ left) ** 2)))
    return waves[int(np.argmax(gains))][0]
