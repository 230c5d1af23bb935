"""The lowest valley of a cost over a few bounded numbers, where slopes lead nowhere.

Points spread evenly, then generations of children of the best: one parent, moved by the difference
of two others and by noise that shrinks from generation to generation.
"""

from collections.abc import Callable

import numpy as np
from scipy.stats import qmc

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
