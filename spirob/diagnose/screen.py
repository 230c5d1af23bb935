"""Screen: which absent effects could explain the residual, to first order?

The whole coupled model is differentiated by each effect's amplitudes at its neutral numbers (all
models are nested), so that every effect, in the motor, along the tendon or in the body, becomes a
few columns over the measured trials, with all its consequences for motion and control in them.
The residual is then regressed on those columns together with the columns of the fitted numbers,
because a wrong parameter is not a missing effect.  Trial by trial is left out and predicted: only
what carries over to another trial counts.  A single trial is cut into thirds instead.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear

from spirob.effects import Effect
from spirob.identify.problem import Problem

PROBE = 0.2  # of an amplitude's nominal value: small, yet far above rounding
WIDE = 1.0  # scaled parameters may move this far to make room for an effect
PARTS = 3  # of a single trial
RIDGE = 1e-3  # of a column's size: keeps nearly parallel columns apart


@dataclass(frozen=True)
class Screened:
    """One candidate after screening.

    gain        relative fall of the squared residual on trials left out, over refitted numbers
    amplitudes  first-order estimate of its amplitudes, a start for the full fit
    """

    effect: type[Effect]
    gain: float
    amplitudes: dict[str, float]


def screen(
    residual: Problem,
    base: np.ndarray,
    jacobian: np.ndarray,
    changes: Mapping[str, float],
    candidates: Sequence[type[Effect]],
    progress: Callable[[str], None] = lambda text: None,
) -> list[Screened]:
    """Rank the candidates; the model of `residual` must hold them all, at their neutral numbers.

    base      residual at `changes`;  jacobian  its derivative by the fitted scaled parameters
    """
    groups = _folds(residual)
    reference = _left_out(jacobian, base, groups, _free(jacobian.shape[1]))
    found = []
    for effect in candidates:
        columns, low, high, sizes = _columns(residual, base, changes, effect)
        design = np.hstack([jacobian, columns])
        free = _free(jacobian.shape[1])
        bounds = (np.append(free[0], low), np.append(free[1], high))
        error = _left_out(design, base, groups, bounds)
        gain = 1.0 - error / reference
        whole = _solve(design, base, bounds)[jacobian.shape[1] :]
        amplitudes = {
            name: float(effect.neutral[name] + a * s)
            for name, a, s in zip(effect.neutral, whole, sizes, strict=True)
        }
        progress(f"{effect.name()}: {gain:+.1%} of the squared residual")
        found.append(Screened(effect, float(gain), amplitudes))
    return sorted(found, key=lambda s: -s.gain)


def _columns(
    residual: Problem, base: np.ndarray, changes: Mapping[str, float], effect: type[Effect]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Derivatives by the amplitudes in units of their nominal value, with bounds in that unit."""
    about = effect.parameters()
    shapes = {f: p.nominal for f, p in about.items() if f not in effect.neutral}
    points, sizes, low, high = [], [], [], []
    for name, neutral in effect.neutral.items():
        size = about[name].nominal - neutral
        size = size if size else 0.1 * (about[name].high - neutral)
        values = {**effect.neutral, **shapes, name: neutral + PROBE * size}
        points.append({**changes, **{f"{effect.name()}.{f}": v for f, v in values.items()}})
        sizes.append(size)
        edges = sorted(((about[name].low - neutral) / size, (about[name].high - neutral) / size))
        low.append(min(edges[0], -1e-9))
        high.append(max(edges[1], 1e-9))
    moved = residual.many(points)
    columns = np.column_stack([(v - base) / PROBE for v in moved])
    return columns, np.array(low), np.array(high), np.array(sizes)


def _folds(residual: Problem) -> np.ndarray:
    trials = len(residual.edges) - 1
    if trials == 1:
        samples = int(residual.edges[-1])
        return np.arange(samples) * PARTS // samples
    return np.repeat(np.arange(trials), np.diff(residual.edges))


def _free(count: int) -> tuple[np.ndarray, np.ndarray]:
    return np.full(count, -WIDE), np.full(count, WIDE)


def _left_out(
    design: np.ndarray,
    base: np.ndarray,
    groups: np.ndarray,
    bounds: tuple[np.ndarray, np.ndarray],
) -> float:
    """Sum of squared residuals of each fold, predicted from the other ones."""
    total = 0.0
    for k in np.unique(groups):
        inside = groups == k
        solution = _solve(design[~inside], base[~inside], bounds)
        total += float(np.sum((base[inside] + design[inside] @ solution) ** 2))
    return total


def _solve(
    design: np.ndarray, base: np.ndarray, bounds: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """argmin |base + design·x|² + ridge within bounds, columns scaled to equal size."""
    size = np.sqrt(np.mean(design**2, axis=0)) + 1e-12
    ridge = RIDGE * np.sqrt(len(base)) * np.eye(len(size))
    stacked = np.vstack([design / size, ridge])
    target = np.concatenate([-base, np.zeros(len(size))])
    return np.asarray(lsq_linear(stacked, target, (bounds[0] * size, bounds[1] * size)).x) / size
