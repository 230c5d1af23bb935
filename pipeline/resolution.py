"""How well the data resolve the fitted numbers: their correlation, and the combination least known.

A step of one is a factor of e for a number that spans decades and its nominal size for the others.
"""

from typing import Any

import numpy as np

from spirob.identify.fit import Fit, block_covariance
from spirob.identify.problem import Problem
from spirob.identify.scaling import Scaling

TENTH = 0.1  # a change of about ten per cent


def resolution(found: Fit, residual: Problem, scale: float) -> dict[str, Any]:
    """Of a fit with its exact slopes, as plain numbers.

    correlation  (n, n) of the fitted numbers, from the covariance that gives their intervals
    weakest      unit combination that moves the effort least, by number
    least, most  RMS change of the effort for a tenth along the weakest and the strongest
                 combination, in its unit
    """
    names = list(found.estimates)
    scaling = Scaling(residual.table, names)
    slopes = scaling.relative(scaling.scaled(found.changes))
    covariance = block_covariance(
        found.jacobian, found.residual, residual.edges, scale, residual.block
    )
    covariance = slopes @ covariance @ slopes.T
    deviation = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    correlation = np.clip(covariance / np.outer(deviation, deviation), -1.0, 1.0)
    _, singular, rows = np.linalg.svd(found.jacobian @ np.linalg.inv(slopes), full_matrices=False)
    weakest = rows[-1] * np.sign(rows[-1][np.argmax(np.abs(rows[-1]))])
    size = TENTH / np.sqrt(len(found.residual))
    return {
        "names": names,
        "correlation": [[float(f"{v:.4g}") for v in row] for row in correlation],
        "weakest": {n: float(f"{v:.4g}") for n, v in zip(names, weakest, strict=True)},
        "least": float(f"{size * singular[-1]:.6g}"),
        "most": float(f"{size * singular[0]:.6g}"),
        "unit": residual.effort.unit,
    }
