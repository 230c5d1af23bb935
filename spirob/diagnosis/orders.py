"""The orders of a ripple: how many waves a turn of the rotor the residual holds.

A ripple's kernel is linear in its amplitudes but not in its orders, so these are looked for where
the other numbers begin: at each order of a grid the residual is regressed on what the model answers
to a sine and a cosine of the rotor's angle (`waves`), separately for each motor, beside the columns
of the fitted numbers.  Of several orders each is found beside the waves of the others.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from spirob.diagnosis.waves import Waves
from spirob.identify.fit import Fit

LOWEST, HIGHEST = 0.03, 50.0  # waves a turn
STEP = 0.03  # to the next order of the grid, relative
PHASE = 0.5  # waves over the whole way by which neighbours differ at most
MOST = 600  # orders in the grid
FINER = 8  # steps to a neighbour, round the best
SAME = 1e-10  # of the largest: waves that differ by less of their square are one
WAVES = 0.4  # of the order's least: so many over the whole way, or it is a slope


def best_orders(
    base: Fit, trials: Sequence[Waves], count: int = 1, least: float = LOWEST
) -> list[float]:
    """The orders that explain most of the residual, lowest first.

    base    the fit without the ripple;  trials  what each answers to waves of it
    least   order that the ripple may have
    """
    way = max(float(np.ptp(r.angle)) for t in trials for r in t.rotors) / (2 * np.pi)
    grid = _grid(way, least)
    waves = _columns(trials, grid)
    found: dict[int, float] = {}
    for place in list(range(count)) * (1 if count == 1 else 2):
        others = [n for k, n in found.items() if k != place]
        known = base.jacobian
        if others:
            known = np.column_stack([known, *_columns(trials, others)])
        free = [k for k, n in enumerate(grid) if _apart(n, others, way)]
        if free:
            best = grid[free[_strongest(base.residual, known, waves[free])]]
            near = best + _step(best, way) * np.arange(1 - FINER, FINER) / FINER
            near = near[near >= grid[0]]
            found[place] = near[_strongest(base.residual, known, _columns(trials, near))]
    return sorted(float(n) for n in found.values())


def _grid(way: float, least: float) -> np.ndarray:
    """Orders to try where the rotor makes `way` turns: no wave falls between two of them."""
    orders = [max(LOWEST, least, WAVES / way)]
    while orders[-1] < HIGHEST and len(orders) < MOST:
        orders.append(orders[-1] + _step(orders[-1], way))
    return np.array(orders)


def _step(order: float, way: float) -> float:
    return min(STEP * order, PHASE / way)


def _apart(order: float, others: Sequence[float], way: float) -> bool:
    """Whether the stroke tells this order from the others: a neighbour is the same wave."""
    return all(abs(order - other) * way > 2 * WAVES for other in others)


def _columns(trials: Sequence[Waves], orders: Sequence[float] | np.ndarray) -> np.ndarray:
    """The waves of some orders in the whole residual, (orders, N, 2·motors)."""
    with ThreadPoolExecutor(trials[0].problem.workers) as pool:
        return np.concatenate(
            list(pool.map(lambda t: t.columns(np.asarray(orders)), trials)), axis=1
        )


def _strongest(residual: np.ndarray, known: np.ndarray, waves: np.ndarray) -> int:
    """Which order's waves explain most of the residual beside the known columns."""
    basis, _ = np.linalg.qr(known)
    left = residual - basis @ (basis.T @ residual)
    own = waves - basis @ (basis.T @ waves)
    across = own.transpose(0, 2, 1)
    told = across @ left
    square = np.linalg.pinv(across @ own, rcond=SAME, hermitian=True)
    return int(np.argmax(np.einsum("ki,kij,kj->k", told, square, told)))
