"""A replay at half the price, for a search that stays near one point.

The model is played in steps of a whole cycle, and what that misses at one point p_0 is put right,

    r(p) ≈ r_1(p) + r_2(p_0) - r_1(p_0),

r_2 being the residual in the plant's own steps.  What is left is the change of the discretisation's
error between the two points.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields

import numpy as np

from spirob.errors import SimulationError
from spirob.identify.problem import Problem, effort_rms
from spirob.identify.residual import Residual

MOST = 0.02  # of the effort's RMS: with a larger correction the long steps are not to be trusted


@dataclass
class Near(Residual):
    """The residual of `exact` close to one point; `correction` (N,) is added to what it finds."""

    exact: Residual = field(kw_only=True)
    correction: np.ndarray = field(kw_only=True)

    def one(self, changes: Mapping[str, float], index: int) -> np.ndarray:
        """The residual of one trial; in the plant's own steps where the long ones diverge."""
        try:
            found = super().one(changes, index)
        except SimulationError:
            return self.exact.one(changes, index)
        return found + self.correction[self.edges[index] : self.edges[index + 1]]


def near(problem: Problem, changes: Mapping[str, float]) -> Problem:
    """The problem at half the price near these numbers; itself where it has no cheaper one."""
    if not isinstance(problem, Residual) or problem.plant.substeps == 1:
        return problem
    own = {f.name: getattr(problem, f.name) for f in fields(Residual)}
    own["plant"] = problem.plant.coarse()
    try:
        correction = problem(changes) - Residual(**own)(changes)
    except SimulationError:
        return problem
    if np.sqrt(np.mean(correction**2)) > MOST * effort_rms(problem):
        return problem
    return Near(**own, exact=problem, correction=correction)
