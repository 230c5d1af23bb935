"""Linear regression within bounds, each fold predicted from the others.

All of it follows from the products of the columns with one another and with the residual, summed
over each fold: the samples are gone through once.
"""

from itertools import pairwise

import numpy as np
import scipy
from numba import njit

RIDGE = 1e-8  # of the mean square of a column
PIVOTS = 20  # of a search for the bounds that hold, all of them at once
ROUNDS = 100  # and one bound each


def products(columns: np.ndarray, residual: np.ndarray, folds: np.ndarray) -> np.ndarray:
    """Sums over each fold of the products of n columns (N, n) and, last, the residual (N,).

    folds  (N,) label of each sample; a fold is a run of equal labels;  result (K, n + 1, n + 1)
    """
    stacked = np.column_stack([columns, residual])
    return np.array([part.T @ part for part in np.split(stacked, _edges(folds))])


def joined(
    sums: np.ndarray,
    columns: np.ndarray,
    more: np.ndarray,
    residual: np.ndarray,
    folds: np.ndarray,
) -> np.ndarray:
    """The `products` of columns and residual with m further columns (N, m) between the two."""
    n, m = columns.shape[1], more.shape[1]
    whole = np.empty((len(sums), n + m + 1, n + m + 1))
    old, new = [*range(n), n + m], slice(n, n + m)
    whole[np.ix_(range(len(sums)), old, old)] = sums
    for k, (a, b) in enumerate(pairwise([0, *_edges(folds), len(folds)])):
        part = more[a:b].T
        whole[k, new, :n] = part @ columns[a:b]
        whole[k, new, new] = part @ more[a:b]
        whole[k, new, -1] = part @ residual[a:b]
        whole[k, :, new] = whole[k, new].T
    return whole


def steps(sums: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """For each fold the coefficients, within bounds, that the other folds choose, (K, n)."""
    others = sums.sum(axis=0) - sums
    return bounded(others[:, :-1, :-1], others[:, :-1, -1], low, high)


def step(sums: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """argmin |r + A·x|² within bounds over all folds, (n,)."""
    whole = sums.sum(axis=0)[None]
    return np.asarray(bounded(whole[:, :-1, :-1], whole[:, :-1, -1], low, high)[0])


def error(sums: np.ndarray, low: np.ndarray, high: np.ndarray) -> float:
    """Squared residual, summed, of the folds left out after a step that the others chose."""
    moved = steps(sums, low, high)
    after = np.column_stack([moved, np.ones(len(moved))])  # the residual itself counts once
    return max(0.0, float(np.einsum("ki,kij,kj->", after, sums, after)))


def left_out_linear(
    columns: np.ndarray,
    residual: np.ndarray,
    folds: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
) -> np.ndarray:
    """The residual of each fold after a step, within bounds, that the other folds chose, (N,)."""
    moved = steps(products(columns, residual, folds), low, high)
    parts = zip(np.split(columns, _edges(folds)), moved, strict=True)
    return residual + np.concatenate([part @ x for part, x in parts])


def _edges(folds: np.ndarray) -> np.ndarray:
    return np.flatnonzero(np.diff(folds)) + 1


def bounded(gram: np.ndarray, side: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """argmin |r + A·x|² within bounds for K residuals, (K, n).

    gram  Aᵀ·A, (K, n, n), or (1, n, n) where it is the same for all;  side  Aᵀ·r, (K, n)
    """
    size = np.sqrt(np.diagonal(gram, axis1=1, axis2=2))
    size = np.where(size > 0.0, size, 1.0)  # a column of zeros gets a coefficient of zero
    scaled = gram / (size[:, :, None] * size[:, None, :]) + RIDGE * np.eye(gram.shape[1])
    goal = np.ascontiguousarray(-side / size)
    size = np.broadcast_to(size, goal.shape)
    found, circling = _within(np.ascontiguousarray(scaled), goal, low * size, high * size)
    for k in np.flatnonzero(circling):
        edges = low * size[k], high * size[k]
        found[k] = _one_by_one(scaled[k % len(scaled)], goal[k], *edges)
    return np.asarray(found / size)


@njit(cache=True, error_model="numpy")
def _within(
    gram: np.ndarray, goal: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """argmin x·G·x/2 - g·x within bounds for K problems, (K, n): block principal pivoting.

    Whatever leaves its bounds is held there, whatever a bound holds against the slope is let go,
    all at once.  Also which of the problems go round in circles, (K,), to be solved one bound at a
    time (Júdice and Pires, Computers & Operations Research 21 (1994)).
    """
    count, n = goal.shape
    found, circling = np.empty((count, n)), np.ones(count, np.bool_)
    for k in range(count):
        own, side = gram[k % len(gram)], np.zeros(n)  # -1 and 1 are held at low and at high
        for _ in range(PIVOTS):
            found[k] = _held(own, goal[k], side, low[k], high[k])
            slope = own @ found[k] - goal[k]
            before = side.copy()
            for i in range(n):
                if before[i] == 0.0:
                    side[i] = 1.0 * (found[k, i] > high[k, i]) - 1.0 * (found[k, i] < low[k, i])
                elif slope[i] * before[i] > 0.0:
                    side[i] = 0.0
            if np.all(side == before):
                circling[k] = False
                break
    return found, circling


@njit(cache=True, error_model="numpy")
def _held(
    gram: np.ndarray, goal: np.ndarray, side: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """The solution with some coefficients at their bounds, (n,)."""
    alone, pushed = gram.copy(), goal.copy()
    for i in np.flatnonzero(side):
        pushed -= (low[i] if side[i] < 0.0 else high[i]) * gram[:, i]
    for i in np.flatnonzero(side):
        alone[i, :], alone[:, i], alone[i, i] = 0.0, 0.0, 1.0
        pushed[i] = low[i] if side[i] < 0.0 else high[i]
    return np.linalg.solve(alone, pushed)


def _one_by_one(
    gram: np.ndarray, goal: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    root = _root(gram)
    target = np.linalg.solve(root, goal)
    found = scipy.optimize.lsq_linear(root.T, target, (low, high), method="bvls", max_iter=ROUNDS)
    return np.asarray(found.x)


def _root(gram: np.ndarray) -> np.ndarray:
    """R with R·Rᵀ = gram, whose least eigenvalue rounding may have taken below the ridge."""
    sizes, axes = np.linalg.eigh(gram)
    return np.asarray(axes * np.sqrt(np.maximum(sizes, RIDGE)))
