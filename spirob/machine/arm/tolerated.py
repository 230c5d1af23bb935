"""Which numbers of an arm's build its logs tell, and which are left as drawn.

A drawing is built within tolerances.  A number is fitted where the logs tell it better than its
tolerance does, all others free beside it; else it is held where the drawing, or the search for the
arm's shape, has it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from spirob.identify.differences import slopes_ahead
from spirob.identify.fit import STEPS
from spirob.identify.intervals import block_covariance
from spirob.identify.problem import Problem
from spirob.identify.scaling import Scaling
from spirob.parameter import Table

# By how much a build may differ, at 95 %, and why
TOLERANCES = {
    "holes.shift": 0.05,  # of a unit's length: 1 to 2 mm, as designs differ
    "holes.mount": 0.005,  # m: mounts are each laboratory's own
    "holes.height": 0.03,  # 1 mm of the base unit's 38
    "arm.stiffness_exponent": 0.3,  # published values lie between 1 and 3
    "arm.stiffness_bow": 0.15,  # flexures 5 % thinner half-way along the arm
    "winch.radius_difference": 0.01,  # how deep the line lies in its groove
}


@dataclass(frozen=True)
class Gate:
    """What logs tell of a build: 95 % half widths by name, of those seen and those held."""

    seen: dict[str, float]
    held: dict[str, float]

    def told(self, numbers: Mapping[str, float], table: Table) -> list[str]:
        """A sentence for each kind; empty where nothing was in question."""
        said = []
        if self.seen:
            listed = ", ".join(
                f"{n} = {numbers[n]:.3g} ± {w:.2g}{_unit(n, table)}" for n, w in self.seen.items()
            )
            said.append(f"Of the arm's build the logs tell {listed}.")
        if self.held:
            listed = ", ".join(f"{n} (± {TOLERANCES[n]:g}{_unit(n, table)})" for n in self.held)
            said.append(f"Held, as they tell less than a build's tolerance does: {listed}.")
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

    Those told least are held first, one by one, as without it the others may be told.
    """
    values = dict(zip(problem.table.names, problem.table.values.tolist(), strict=True))
    values |= dict(numbers)
    scaling = Scaling(problem.table, names)
    u = scaling.scaled({n: values[n] for n in names})
    fixed = {n: v for n, v in numbers.items() if n not in names}
    at = problem(numbers)
    slopes = slopes_ahead(problem, scaling, u, fixed, at, STEPS[-1])
    held: dict[str, float] = {}
    while True:
        kept = [n for n in names if n not in held]
        columns = [names.index(n) for n in kept]
        part = Scaling(problem.table, kept)
        inside = part.scaled({n: values[n] for n in kept})
        covariance = block_covariance(slopes[:, columns], at, problem.edges, scale, problem.block)
        ends = zip(kept, *part.spread(inside, covariance), strict=True)  # cut to their bounds
        widths = {n: float(max(high - values[n], values[n] - low)) for n, low, high in ends}
        left = {n: widths[n] for n in asked if n in kept}
        worst = max(left, key=lambda n: left[n] / TOLERANCES[n], default="")
        if not worst or left[worst] < TOLERANCES[worst]:
            return Gate(left, held)
        held[worst] = left[worst]


def _unit(name: str, table: Table) -> str:
    unit = table.about[name].unit
    return "" if unit == "1" else f" {unit}"
