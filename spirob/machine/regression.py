"""Linear regression within bounds, each fold of the samples predicted from the others.

All of it follows from the products of the columns with one another and with the residual, summed
over each fold: the samples are gone through once.
"""

import numpy as np
from scipy.optimize import lsq_linear

RIDGE = 1e-8  # of the mean square of a column
ROUNDS = 100  # of a search for the bounds that hold, one bound each


def products(columns: np.ndarray, residual: np.ndarray, folds: np.ndarray) -> np.ndarray:
    """Sums over each fold of the products of n columns (N, n) and, last, the residual (N,).

    folds  (N,) label of each sample; a fold is a run of equal labels;  result (K, n + 1, n + 1)
    """
    stacked = np.column_stack([columns, residual])
    return np.array([part.T @ part for part in np.split(stacked, _edges(folds))])


def steps(sums: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """For each fold the coefficients, within bounds, that the other folds choose, (K, n)."""
    return _solved(sums.sum(axis=0) - sums, low, high)


def step(sums: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """argmin |r + A·x|² within bounds over all folds, (n,)."""
    return np.asarray(_solved(sums.sum(axis=0)[None], low, high)[0])


def error(sums: np.ndarray, low: np.ndarray, high: np.ndarray) -> float:
    """Squared residual, summed, of the folds left out after a step that the others chose."""
    moved = steps(sums, low, high)
    after = np.column_stack([moved, np.ones(len(moved))])  # the residual itself counts once
    return max(0.0, float(np.einsum("ki,kij,kj->", after, sums, after)))


def left_out(
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


def _solved(sums: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """argmin |r + A·x|² within bounds from each entry of `sums`, (K, n)."""
    gram, side = sums[:, :-1, :-1], sums[:, :-1, -1]
    size = np.sqrt(np.diagonal(gram, axis1=1, axis2=2))
    size = np.where(size > 0.0, size, 1.0)  # a column of zeros gets a coefficient of zero
    scaled = gram / (size[:, :, None] * size[:, None, :]) + RIDGE * np.eye(gram.shape[1])
    goal = -side / size
    found = np.linalg.solve(scaled, goal[:, :, None])[:, :, 0] / size
    for k in np.flatnonzero(np.any((found < low) | (found > high), axis=1)):
        root = _root(scaled[k])
        box = (low * size[k], high * size[k])
        target = np.linalg.solve(root, goal[k])
        found[k] = lsq_linear(root.T, target, box, method="bvls", max_iter=ROUNDS).x / size[k]
    return np.asarray(found)


def _root(gram: np.ndarray) -> np.ndarray:
    """R with R·Rᵀ = gram, whose least eigenvalue rounding may have taken below the ridge."""
    sizes, axes = np.linalg.eigh(gram)
    return np.asarray(axes * np.sqrt(np.maximum(sizes, RIDGE)))
