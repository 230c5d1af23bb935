"""What a fitted model leaves of data that its fit has not seen: each fold by the others' numbers.

The numbers that the other folds ask for are a step of Gauss and Newton away from those of all, and
the model is evaluated there.  Where it is bent on the way (a limit of the torque that one fold
alone reaches, a band within which nothing moves), that step goes astray, and the others are fitted
anew.
"""

import numpy as np
from scipy.optimize import least_squares

from spirob.identify.descent import slopes_ahead
from spirob.identify.fit import Fit
from spirob.identify.scaling import Scaling
from spirob.machine.flexible import products, steps
from spirob.machine.inverse import InverseProblem
from spirob.machine.screening import room

BENT = 0.1  # of the residual: by so much it may differ from what its slopes told of a step
WORST = 1e6  # of the largest residual: by how much more a fold is missed says nothing
STEPS = 4  # of a fit to the others: it begins close to where it ends


def left_out(problem: InverseProblem, found: Fit, folds: np.ndarray, width: float) -> np.ndarray:
    """The residual of each fold by the numbers that the other folds ask for, (N,).

    A fold on which the others' numbers run away is missed by `WORST`, never by what has no square.

    found  fitted to all of them;  folds  (N,) label of each sample
    width  of differences, in the coordinates of `Scaling`
    """
    scaling = Scaling(problem.table, list(found.estimates))
    moved = steps(products(found.jacobian, found.residual, folds), *room(problem.table, found))
    begin, out = scaling.scaled(found.changes), np.empty_like(found.residual)
    starts = np.flatnonzero(np.diff(folds, prepend=folds[0] - 1))
    for fold, step in zip(folds[starts], moved, strict=True):
        inside = folds == fold
        residual = problem(found.changes | scaling.physical(begin + step))
        told = found.residual + found.jacobian @ step
        with np.errstate(over="ignore"):
            off = np.linalg.norm(residual - told)
        if off > BENT * np.linalg.norm(found.residual):
            numbers = _fitted(problem, scaling, found, ~inside, width)
            residual = problem(found.changes | numbers)
        out[inside] = residual[inside]
    worst = WORST * float(np.max(np.abs(found.residual)))
    return np.clip(np.nan_to_num(out, nan=worst), -worst, worst)


def _fitted(
    problem: InverseProblem, scaling: Scaling, found: Fit, others: np.ndarray, width: float
) -> dict[str, float]:
    """The numbers fitted to some samples alone, from those that fit all."""
    margin = 1e-3 * (scaling.high - scaling.low)
    begin = np.clip(scaling.scaled(found.changes), scaling.low + margin, scaling.high - margin)

    def value(u: np.ndarray) -> np.ndarray:
        return problem(found.changes | scaling.physical(u))[others]

    def slopes(u: np.ndarray) -> np.ndarray:
        at = problem(found.changes | scaling.physical(u))
        return slopes_ahead(problem, scaling, u, found.changes, at, width)[others]

    bounds = scaling.low, scaling.high
    ended = least_squares(value, begin, slopes, bounds, max_nfev=STEPS, xtol=1e-4, ftol=1e-4)
    return scaling.physical(ended.x)
