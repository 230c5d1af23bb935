"""The shape of an arm of another design: searched for, and what its logs tell of it.

An arm whose hinges snap has a cost with many valleys, most of them as deep as each other, in which
a fit ends where it began.  The length that the other motor winds in has wide ones: how much both
tendons together are shortened by a bend follows from where their holes are.  So the numbers of
`SHAPE` are searched for with that length weighed heavily, while those of the motors, on
which the current depends nearly linearly, are put right in each draw by one step with derivatives
at a first fit.

The lowest valley of that cost is looked for by points spread evenly, then by generations of
children of the best: one parent, moved by the difference of two others and by noise that shrinks
from generation to generation.

A drawing is built within tolerances.  A number is fitted where the logs halve what is not known of
it, all others free beside it within theirs; else it is held where the drawing, or the search for
the arm's shape, has it.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from spirob.errors import SimulationError
from spirob.identify.builds import SURE, TOLERANCES
from spirob.identify.descent import linear_step, robust_cost, slopes_ahead
from spirob.identify.fit import STEPS, Fit
from spirob.identify.measurement import Measurement
from spirob.identify.problem import Problem
from spirob.identify.residual import Residual, near
from spirob.identify.scaling import STRENGTH, Scaling
from spirob.parameter import Parameter, Table

FIRST, CHILDREN, GENERATIONS, PARENTS = 128, 48, 6, 8
DIFFERENCE = 0.6  # of two parents, added to a third
NOISE, SHRINKS = 0.075, 1.6  # share of the range in the first generation, and by what it falls


def evolved(
    cost: Callable[[np.ndarray], float], dimensions: int, progress: Callable[[str], None]
) -> np.ndarray:
    """The best of some four hundred points in the unit cube, (dimensions,); the same each time.

    cost  of a point; infinite where it cannot be told
    """
    rng = np.random.default_rng(0)
    points = list(scipy.stats.qmc.Sobol(dimensions, rng=0).random(FIRST))
    costs = [cost(point) for point in points]
    for generation in range(GENERATIONS):
        best = [points[k] for k in np.argsort(costs, kind="stable")[:PARENTS]]
        progress(f"search for the arm's shape: {generation} of {GENERATIONS} generations")
        noise = NOISE / SHRINKS**generation
        for _ in range(CHILDREN):
            first = best[min(rng.integers(PARENTS, size=2))]  # rather a good one
            second, third = (best[k] for k in rng.integers(PARENTS, size=2))
            moved = first + DIFFERENCE * (second - third)
            points.append(np.clip(moved + noise * rng.standard_normal(dimensions), 0.0, 1.0))
            costs.append(cost(points[-1]))
    return points[int(np.argmin(costs))]


# What is drawn, and between what, None for the arm's own bounds; of the stiffness a factor on what
# the first fit has
SHAPE: dict[str, tuple[float, float] | None] = {
    "arm.base_stiffness": (0.7, 1.5),
    "arm.stiffness_exponent": (1.2, 1.8),
    "arm.bends_per_hinge": (0.8, 2.0),
    "holes.shift": None,
    "holes.mount": None,
}
FREED = ("arm.stiffness_exponent", "holes.shift", "holes.mount")  # fitted then, beside the usual
LENGTH = 40.0  # A/m: a millimetre counts as much as what a wrong valley leaves of the current
HARD = ("arm", "holes")  # owners of numbers that no step puts right


def searched_shape(
    train: Residual,
    found: Fit,
    free: Sequence[str],
    scale: float,
    progress: Callable[[str], None],
) -> dict[str, float]:
    """Numbers near the lowest valley, to begin a fit with; those of `found` and `SHAPE`.

    found  a fit without them, of the stiffness too;  free  those of `SHAPE` that may be drawn
    scale  of the robust loss [A]
    """
    about = train.table.about
    shape = {
        name: ends or (about[name].low, about[name].high)
        for name, ends in SHAPE.items()
        if name in free
    }
    heavy = near(replace(train, length=LENGTH, trials=_deepest(train)), found.changes)
    assert isinstance(heavy, Residual)
    scaling = Scaling(train.table, list(found.estimates))
    u = scaling.scaled({n: found.changes[n] for n in scaling.names})
    easy = [k for k, n in enumerate(scaling.names) if n.split(".")[0] not in HARD and n != STRENGTH]
    fixed = {n: v for n, v in found.changes.items() if n not in scaling.names}
    at = heavy(found.changes)
    slopes = slopes_ahead(heavy, scaling, u, fixed, at, STEPS[-1])[:, easy]
    low, high = scaling.around(u)
    room = (low - u)[easy], (high - u)[easy]
    wide = scale * LENGTH / train.length

    def tried(drawn: np.ndarray) -> tuple[float, dict[str, float]]:
        numbers = {**found.changes, **drawn_shape(found.changes, about, shape, drawn)}
        try:
            missed = heavy(numbers)
        except SimulationError:
            return np.inf, numbers
        step = linear_step(missed, slopes, room, wide)
        moved = u.copy()
        moved[easy] += step
        right = scaling.physical(np.clip(moved, low, high))
        numbers |= {scaling.names[k]: right[scaling.names[k]] for k in easy}
        return robust_cost(missed + slopes @ step, wide), numbers

    best = evolved(lambda drawn: tried(drawn)[0], len(shape), progress)
    return tried(best)[1]


def _deepest(train: Residual) -> list[Measurement]:
    """Of each working motor the trial with the longest way: the shape shows in a deep bend."""
    deepest: dict[tuple[int, ...], tuple[float, Measurement]] = {}
    for trial in train.trials:
        working = tuple(train.driven(trial))
        way = float(np.ptp(trial.displacement[:, working], axis=0).max(initial=0.0))
        if working not in deepest or way > deepest[working][0]:
            deepest[working] = way, trial
    return [trial for _, trial in deepest.values()]


def drawn_shape(
    first: Mapping[str, float],
    about: Mapping[str, Parameter],
    shape: Mapping[str, Sequence[float]],
    drawn: np.ndarray,
) -> dict[str, float]:
    """Numbers of a shape at a point of the unit cube, within what the model allows."""
    values = {
        n: a + (b - a) * float(x) for (n, (a, b)), x in zip(shape.items(), drawn, strict=True)
    }
    if (name := "arm.base_stiffness") in values:
        values[name] *= first[name]
    return {n: float(np.clip(v, about[n].low, about[n].high)) for n, v in values.items()}


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
