"""A smooth and cheap residual, as an inverse model's is, walked to its very optimum."""

from collections.abc import Callable, Mapping

import numpy as np
from scipy import optimize

from spirob.identify.descent import Descent
from spirob.identify.differences import slopes_ahead
from spirob.identify.problem import Problem
from spirob.identify.scaling import Scaling


def to_the_optimum(
    residual: Problem,
    scaling: Scaling,
    value: Callable[[np.ndarray], np.ndarray],
    start: np.ndarray,
    fixed: Mapping[str, float],
    scale: float,
    iterations: int,
    step: float,
) -> Descent:
    """By trust regions; differences of one width `step`, at most `iterations` of them."""
    slopes = np.zeros((0, 0))

    def jacobian(at: np.ndarray) -> np.ndarray:
        nonlocal slopes
        slopes = slopes_ahead(residual, scaling, at, fixed, value(at), step)
        return slopes

    found = optimize.least_squares(
        value,
        start,
        jac=jacobian,
        method="trf",
        bounds=(scaling.low, scaling.high),
        loss="soft_l1",
        f_scale=scale,
        max_nfev=iterations,
        xtol=1e-4,
        ftol=1e-4,
        gtol=1e-10,
    )
    u = np.asarray(found.x)
    return Descent(u, value(u), slopes, float(found.cost))
