"""What inertia, friction, a force and a weight explain of an effort, without any search."""

from collections.abc import Sequence

import numpy as np
import scipy

from spirob.machine.inverse.problem import InverseProblem

RESISTING = 3  # plain columns that only resist: inertia, viscous and dry friction


def plain_columns(problem: InverseProblem, times: float = 1.0) -> list[np.ndarray]:
    """What inertia, viscous and dry friction make, then a force and a weight, (N,) each.

    times  factor of the motion, for a log whose unit may be another
    """
    motion = problem.asked.motion
    q, v, a = times * motion.q, times * motion.v, times * motion.a
    columns = [a, v, np.sign(v), np.ones_like(v)]
    if problem.rig.position is not None:
        columns.append(q)
        if problem.sizes.axis_unit == "rad":
            columns += [np.sin(q), np.cos(q)]
    return [problem.smoothed(column) for column in columns]


def beside_plain(
    effort: np.ndarray,
    plain: Sequence[np.ndarray],
    resisting: int,
    columns: np.ndarray,
    within: tuple[float, float] = (-np.inf, np.inf),
) -> tuple[np.ndarray, float]:
    """Numbers (k,) of columns (N, k) that fit an effort (N,) beside plain ones; mean square left.

    resisting  how many of the plain columns, the first ones, can only resist
    within     bounds of the numbers of `columns`
    """
    count, rest = columns.shape[1], len(plain) - resisting
    design = np.column_stack([columns, *plain])
    size = np.linalg.norm(design, axis=0) + 1e-300
    low = np.r_[within[0] * size[:count], np.zeros(resisting), np.full(rest, -np.inf)]
    high = np.r_[within[1] * size[:count], np.full(len(plain), np.inf)]
    found = scipy.optimize.lsq_linear(design / size, effort, (low, high)).x
    left = float(np.mean((effort - design / size @ found) ** 2))
    return (found / size)[:count], left


def plain_numbers(effort: np.ndarray, plain: Sequence[np.ndarray], resisting: int) -> np.ndarray:
    """Numbers (k,) of plain columns that fit an effort (N,); the first ones can only resist."""
    design = np.column_stack(plain)
    size = np.linalg.norm(design, axis=0) + 1e-300
    low = np.r_[np.zeros(resisting), np.full(len(plain) - resisting, -np.inf)]
    found = scipy.optimize.lsq_linear(design / size, effort, (low, np.full(len(plain), np.inf)))
    return np.asarray(found.x / size)


def explained(measured: np.ndarray, modelled: np.ndarray, constant: float | None = None) -> float:
    """Share of the variance that a model explains; below 0 where it misses more than the mean.

    constant  that takes the place of the mean
    """
    about = np.mean(measured) if constant is None else constant
    spread = max(float(np.mean((measured - about) ** 2)), 1e-300)
    return 1.0 - float(np.mean((modelled - measured) ** 2)) / spread
