"""Where the fit of an arm of another design begins: its holes and stiffness, searched for.

An arm whose hinges snap has a cost with many valleys, most of them as deep as each other, in which
a fit ends where it began.  The length that the other motor winds in has wide ones: how much both
tendons together are shortened by a bend follows from where their holes are.  So the numbers of
`SHAPE` are searched for (`shape`) with that length weighed heavily, while those of the motors, on
which the current depends nearly linearly, are put right in each draw by one step with derivatives
at a first fit.

The lowest valley of a cost over a few bounded numbers, where slopes lead nowhere.

Points spread evenly, then generations of children of the best: one parent, moved by the difference
of two others and by noise that shrinks from generation to generation.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import qmc

from spirob.errors import SimulationError
from spirob.identify.coarse import near
from spirob.identify.descent import linear_step, robust_cost, slopes_ahead
from spirob.identify.fit import STEPS, Fit
from spirob.identify.residual import Residual
from spirob.identify.scaling import STRENGTH, Scaling

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
    points = list(qmc.Sobol(dimensions, rng=0).random(FIRST))
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
EASY = ("motor", "winch", "tendon")  # owners of numbers that are put right in each draw


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
    heavy = near(replace(train, length=LENGTH), found.changes)
    assert isinstance(heavy, Residual)
    scaling = Scaling(train.table, list(found.estimates))
    u = scaling.scaled({n: found.changes[n] for n in scaling.names})
    easy = [k for k, n in enumerate(scaling.names) if n.split(".")[0] in EASY and n != STRENGTH]
    fixed = {n: v for n, v in found.changes.items() if n not in scaling.names}
    at = heavy(found.changes)
    slopes = slopes_ahead(heavy, scaling, u, fixed, at, STEPS[-1])[:, easy]
    low, high = scaling.around(u)
    room = (low - u)[easy], (high - u)[easy]
    wide = scale * LENGTH / train.length

    def tried(drawn: np.ndarray) -> tuple[float, dict[str, float]]:
        numbers = {**found.changes, **_drawn(found.changes, shape, drawn)}
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


def _drawn(
    first: Mapping[str, float], shape: Mapping[str, Sequence[float]], drawn: np.ndarray
) -> dict[str, float]:
    values = {
        n: a + (b - a) * float(x) for (n, (a, b)), x in zip(shape.items(), drawn, strict=True)
    }
    if (name := "arm.base_stiffness") in values:
        values[name] *= first[name]
    return values
