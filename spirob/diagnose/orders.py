"""The order of a ripple: how many waves a turn of the rotor the residual holds.

A ripple's kernel is linear in its amplitudes but not in its order, so the order is looked for where
the other numbers begin: at each order of a fine grid the residual is regressed on sine and cosine
of the rotor's angle and of twice that angle, separately for each motor, beside the columns of the
fitted numbers.
"""

from collections.abc import Sequence

import numpy as np

from spirob.identify.problem import Problem, Stretch

GRID = np.geomspace(0.03, 50.0, 160)
WAVES = 0.4  # of the order's least: so many over the whole way, or it is a slope
OCTAVE = 0.9  # of the gain, that twice the order has to keep
FASTEST = 0.5  # waves a sample of the residual, most of the time


def best_order(problem: Problem, residual: np.ndarray, slopes: np.ndarray, by_load: bool) -> float:
    """The order that explains most of the residual; 0 where the angle is not known.

    slopes   derivatives of the residual by the fitted numbers, (N, n)
    by_load  the wave grows with the effort, as a ripple of the torque constant does
    """
    pieces = problem.stretches()
    if any(p.angle is None for p in pieces):
        return 0.0
    rows = problem.rows
    basis, _ = np.linalg.qr(slopes[rows])
    left = residual[rows] - basis @ (basis.T @ residual[rows])
    angle = np.concatenate([p.angle for p in pieces if p.angle is not None])
    weight = np.concatenate([p.effort for p in pieces]) if by_load else np.ones(len(angle))
    motors = _motors(pieces)
    way = max(float(np.ptp(p.angle)) for p in pieces if p.angle is not None) / (2 * np.pi)
    pace = float(np.quantile(np.abs(np.diff(angle)), 0.8)) / (2 * np.pi)
    grid = GRID[(GRID * way > WAVES) & (2.0 * GRID * pace < FASTEST)]
    if len(grid) == 0:
        return 0.0
    gains = [_gain(left, basis, n * angle, weight, motors) for n in grid]
    order, gain = float(grid[int(np.argmax(gains))]), max(gains)
    # half an order explains a wave as its second harmonic: the highest that does as well is meant
    while 2.0 * order <= grid[-1]:
        doubled = _gain(left, basis, 2.0 * order * angle, weight, motors)
        if doubled < OCTAVE * gain:
            break
        order, gain = 2.0 * order, doubled
    return order


def _motors(pieces: Sequence[Stretch]) -> np.ndarray:
    """Which motor each sample belongs to, (N, motors) of zeros and ones."""
    names = sorted({p.channel for p in pieces})
    of = np.concatenate([np.full(len(p.seconds), names.index(p.channel)) for p in pieces])
    return np.asarray(of[:, None] == np.arange(len(names)), dtype=float)


def _gain(
    left: np.ndarray, basis: np.ndarray, phase: np.ndarray, weight: np.ndarray, motors: np.ndarray
) -> float:
    waves = [f(m * phase) * weight for m in (1, 2) for f in (np.sin, np.cos)]
    columns = np.column_stack([w * of for w in waves for of in motors.T])
    columns -= basis @ (basis.T @ columns)
    own, _ = np.linalg.qr(columns)
    return float(np.sum((own.T @ left) ** 2))
