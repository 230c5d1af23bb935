"""First-order screening on an inverse problem: which absent effects explain what is left?

Each effect becomes a few columns, the residual's derivatives by its amplitudes, for several starts
of its shape; the residual is regressed on them together with the columns of everything fitted, and
each fold is predicted from the others.  Pairs are tried on the same columns: a true effect may
raise the error when it is added alone.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.optimize import lsq_linear

from spirob.effects import Effect
from spirob.identify.fit import Fit
from spirob.identify.scaling import Scaling
from spirob.machine.inverse import InverseProblem
from spirob.machine.shapes import grid, starts
from spirob.parameter import Parameter, Table

GRIDDED, WALK = 2, 6  # numbers of a shape that a grid still covers; places on a walk along one
PROBE = 0.2  # of an amplitude's nominal value
RIDGE = 1e-8  # of the mean square of a column
ABSORBED = (
    1e-3  # share of a column outside the span of the fitted numbers: below, it is one of them
)


@dataclass(frozen=True)
class Offer:
    """An effect with the shape that suits it best.

    values   all its numbers, by full name, to start a fit from
    columns  (N, amplitudes);  low, high  bounds of their coefficients
    error    mean squared residual of folds left out
    new      share of its columns that the fitted numbers cannot make
    """

    effect: type[Effect]
    values: dict[str, float]
    columns: np.ndarray
    low: np.ndarray
    high: np.ndarray
    sizes: np.ndarray
    error: float
    new: float


class Screening:
    """Screening around one fitted model of a problem; `folds` (N,) is the label of each sample."""

    def __init__(self, problem: InverseProblem, at: Fit, folds: np.ndarray):
        self.problem, self.residual, self.jacobian = problem, at.residual, at.jacobian
        self.changes, self.folds = dict(at.changes), folds
        self._room = room(problem.table, at)
        self._signals = {**problem.signals(), "effort": problem.measured()}
        sizes = np.linalg.norm(at.jacobian, axis=0) + 1e-300
        self._q = np.linalg.qr(at.jacobian / sizes)[0]

    def offers(self, effects: Sequence[type[Effect]]) -> list[Offer]:
        """The effects, each at its best shape, best first."""
        found = []
        for effect in effects:
            table = self.problem.table
            about = {f: table.about[f"{effect.name()}.{f}"] for f in effect.parameters()}
            if len(about) - len(effect.neutral) > GRIDDED:
                found.append(self._walked(effect, about))
                continue
            shapes = starts(effect, about, self.residual, self._signals)
            tried = [self._offer(effect, shape) for shape in shapes]
            found.append(min(tried, key=lambda offer: offer.error))
        return sorted(found, key=lambda offer: offer.error)

    def _walked(self, effect: type[Effect], about: Mapping[str, Parameter]) -> Offer:
        """The best shape by walking along one number after the other, from the nominal ones."""
        shape = {f: p.nominal for f, p in about.items() if f not in effect.neutral}
        best = self._offer(effect, shape)
        for field in [*shape, *shape]:
            for value in grid(about[field], WALK):
                tried = self._offer(effect, {**shape, field: value})
                if tried.error < best.error:
                    best, shape = tried, {**shape, field: value}
        return best

    def pairs(self, offers: Sequence[Offer]) -> list[tuple[float, Offer, Offer]]:
        """All pairs of offers with the error of the two together, best first."""
        found = []
        for one, two in combinations(offers, 2):
            columns = np.hstack([one.columns, two.columns])
            bounds = (np.append(one.low, two.low), np.append(one.high, two.high))
            found.append((self._left_out(columns, *bounds), one, two))
        return sorted(found, key=lambda entry: entry[0])

    def _offer(self, effect: type[Effect], shape: Mapping[str, float]) -> Offer:
        table, name = self.problem.table, effect.name()
        at_shape = {f"{name}.{f}": v for f, v in shape.items()}
        columns, low, high, sizes = [], [], [], []
        for field in effect.neutral:
            full = f"{name}.{field}"
            about, zero = table.about[full], float(table.values[table.position(full)])
            size = about.nominal - zero or 0.02 * (about.high - zero)
            point = {**self.changes, **at_shape, full: zero + PROBE * size}
            columns.append((self.problem(point) - self.residual) / PROBE)
            sizes.append(size)
            edges = sorted(((about.low - zero) / size, (about.high - zero) / size))
            low.append(min(edges[0], -1e-9))
            high.append(max(edges[1], 1e-9))
        stacked = np.column_stack(columns)
        bounds = np.array(low), np.array(high)
        error = self._left_out(stacked, *bounds)
        design = np.hstack([self.jacobian, stacked])
        whole = _solve(design.T @ design, design.T @ self.residual, *self._bounds(*bounds))
        coefficients = whole[self.jacobian.shape[1] :]
        values = dict(at_shape)
        for k, field in enumerate(effect.neutral):
            full = f"{name}.{field}"
            about, zero = table.about[full], float(table.values[table.position(full)])
            values[full] = float(np.clip(zero + coefficients[k] * sizes[k], about.low, about.high))
        outside = stacked - self._q @ (self._q.T @ stacked)
        new = float(np.linalg.norm(outside) / (np.linalg.norm(stacked) + 1e-300))
        return Offer(effect, values, stacked, *bounds, np.array(sizes), error, new)

    def _bounds(self, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.append(self._room[0], low), np.append(self._room[1], high)

    def _left_out(self, columns: np.ndarray, low: np.ndarray, high: np.ndarray) -> float:
        design = np.hstack([self.jacobian, columns])
        left = left_out(design, self.residual, self.folds, *self._bounds(low, high))
        return float(np.mean(left**2))


def room(table: Table, at: Fit) -> tuple[np.ndarray, np.ndarray]:
    """How far each fitted number may move from where it is, in the coordinates of its slopes."""
    scaling = Scaling(table, list(at.estimates))
    u = scaling.scaled(at.changes)
    return np.minimum(scaling.low - u, -1e-9), np.maximum(scaling.high - u, 1e-9)


def left_out(
    design: np.ndarray,
    residual: np.ndarray,
    folds: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
) -> np.ndarray:
    """The residual of each fold after a step, within bounds, that the other folds chose, (N,)."""
    labels = np.unique(folds)
    grams = {k: design[folds == k].T @ design[folds == k] for k in labels}
    sides = {k: design[folds == k].T @ residual[folds == k] for k in labels}
    gram, side = sum(grams.values()), sum(sides.values())
    out = np.empty_like(residual)
    for k in labels:
        step = _solve(gram - grams[k], side - sides[k], low, high)
        out[folds == k] = residual[folds == k] + design[folds == k] @ step
    return out


def _solve(gram: np.ndarray, side: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """argmin |r + A·x|² within bounds, from AᵀA and Aᵀr."""
    size = np.sqrt(np.diag(gram))
    size = np.where(size > 0.0, size, 1.0)  # a column of zeros gets a coefficient of zero
    scaled = gram / np.outer(size, size) + RIDGE * np.eye(len(size))
    free = np.linalg.solve(scaled, -side / size) / size
    if np.all(free >= low) and np.all(free <= high):
        return np.asarray(free)
    root = np.linalg.cholesky(scaled)
    target = np.linalg.solve(root, -side / size)
    found = lsq_linear(root.T, target, (low * size, high * size))
    return np.asarray(found.x) / size
