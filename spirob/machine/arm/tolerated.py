"""Which numbers of an arm's build its logs tell, and which are left as drawn.

A drawing is built within tolerances.  A number is fitted where the logs halve what is not known of
it, all others free beside it within theirs; else it is held where the drawing, or the search for
the arm's shape, has it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spirob.identify.builds import SURE, TOLERANCES
from spirob.identify.descent import slopes_ahead
from spirob.identify.fit import STEPS
from spirob.identify.problem import Problem
from spirob.identify.scaling import Scaling
from spirob.parameter import Table

TOLD = 0.5  # of its tolerance: what is known of a number that counts as seen


@dataclass(frozen=True)
class Gate:
    """What logs tell of a build: 95 % half widths by name, of those seen and those held."""

    seen: dict[str, float]
    held: dict[str, float]

    def told(self, numbers: Mapping[str, float], table: Table) -> list[str]:
        """A sentence for each kind; empty where nothing was in question."""
        said = []
        if self.seen:
            at = {n: numbers.get(n, float(table.values[table.position(n)])) for n in self.seen}
            listed = ", ".join(
                f"{n} = {at[n]:.3g} ± {w:.2g}{_unit(n, table)}" for n, w in self.seen.items()
            )
            said.append(f"Of the arm's build the logs tell {listed}.")
        if self.held:
            listed = ", ".join(f"{n} (± {TOLERANCES[n]:g}{_unit(n, table)})" for n in self.held)
            said.append(f"Held, as they tell little more than a build's tolerance does: {listed}.")
        return said


def gate(
    problem: Problem,
    names: Sequence[str],
    numbers: Mapping[str, float],
    asked: Sequence[str],
    scale: float,
) -> Gate:
    """Which of `asked` the logs tell beside the numbers fitted.

    names  of all numbers fitted, those asked for among them;  numbers  where they stand
    scale  of the robust loss [A]

    To first order, C = (JᵀWJ/σ² + P)⁻¹, with the tolerances in P, and σ² the mean square of what
    is left times the samples of half a second, which say the same thing.
    """
    values = dict(zip(problem.table.names, problem.table.values.tolist(), strict=True))
    values |= dict(numbers)
    scaling = Scaling(problem.table, names)
    u = scaling.scaled({n: values[n] for n in names})
    fixed = {n: v for n, v in numbers.items() if n not in names}
    at = problem(numbers)
    slopes = slopes_ahead(problem, scaling, u, fixed, at, STEPS[-1])
    weight = 1.0 / np.sqrt(1.0 + (at / scale) ** 2)  # of the soft-L1 loss
    left = problem.block * float(np.mean(weight * at**2))
    known = np.array([TOLERANCES[n] / SURE if n in asked else 1.0 for n in names])
    sizes = np.where([n in asked for n in names], scaling.size, 1.0)
    told = slopes.T @ (weight[:, None] * slopes) / left + np.diag((sizes / known) ** 2)
    widths = SURE * sizes * np.sqrt(np.diag(np.linalg.inv(told)))
    found = {n: float(w) for n, w in zip(names, widths, strict=True) if n in asked}
    seen = {n: w for n, w in found.items() if w < TOLD * TOLERANCES[n]}
    return Gate(seen, {n: w for n, w in found.items() if n not in seen})


def _unit(name: str, table: Table) -> str:
    unit = table.about[name].unit
    return "" if unit == "1" else f" {unit}"
