"""The gate before a fit: does each parameter move a signal, and which combination does not?"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spirob.identify.fit import differences
from spirob.identify.problem import Problem, effort_rms
from spirob.identify.scaling import Scaling

SILENT = 2e-6  # of the effort's RMS per relative change: far below the resolution of any drive
WEAK = 1e-2  # a direction this much weaker than the strongest is called weak


@dataclass(frozen=True)
class Identifiability:
    """What the data can say about a set of parameters.

    silent     parameters that move no signal
    condition  ratio of the strongest to the weakest direction
    weakest    coefficients of the weakest direction, by parameter
    sentence   the same in words
    """

    silent: list[str]
    condition: float
    weakest: dict[str, float]
    sentence: str


def probe(residual: Problem, names: Sequence[str], start: Mapping[str, float]) -> Identifiability:
    """Differentiate the residual at `start` by each named parameter and look at the directions."""
    table = residual.table
    scaling = Scaling(table, names)
    values = {n: start.get(n, float(table.values[table.position(n)])) for n in names}
    fixed = {k: v for k, v in start.items() if k not in names}
    u = scaling.scaled(values)
    jacobian = differences(residual, scaling, u, fixed) @ np.linalg.inv(scaling.relative(u))
    strength = np.sqrt(np.mean(jacobian**2, axis=0))
    least = SILENT * effort_rms(residual)
    silent = [n for n, s in zip(names, strength, strict=True) if s < least]
    _, singular, rows = np.linalg.svd(jacobian, full_matrices=False)
    weakest = {n: float(c) for n, c in zip(names, rows[-1], strict=True)}
    condition = float(singular[0] / max(singular[-1], 1e-300))
    return Identifiability(
        silent, condition, weakest, _sentence(silent, condition, weakest, residual.effort.name)
    )


def _sentence(
    silent: list[str], condition: float, weakest: Mapping[str, float], effort: str
) -> str:
    if silent:
        return f"These parameters move no signal and cannot be fitted: {', '.join(silent)}."
    if condition * WEAK < 1.0:
        return f"Every fitted parameter, and every combination of them, moves the {effort} clearly."
    strong = sorted(weakest, key=lambda n: -abs(weakest[n]))
    named = [f"{n} {'up' if weakest[n] > 0 else 'down'}" for n in strong if abs(weakest[n]) > 0.3]
    return (
        f"The data hold least on moving {' with '.join(named)} together: "
        f"{condition:.0f} times less than on the strongest combination."
    )
