"""The machines that play the drawn training wraps: no two have the same numbers.

A model is never quite the robot.  What is learned from one model alone leans on whatever tells its
sizes best, on features too that the robot has otherwise; learned from many machines about the model
it has to do with what they have in common (domain randomisation: Tobin et al., IROS 2017).
"""

from collections.abc import Mapping, Sequence

import numpy as np

from pipeline.schema import Config
from spirob.effects import Effect
from spirob.parameter import Table

MACHINES = 9  # stream of the seed


def numbers_of(
    config: Config,
    effects: Sequence[type[Effect]],
    table: Table,
    changes: Mapping[str, float],
    k: int,
) -> dict[str, float]:
    """Numbers of the machine that plays the k-th drawn wrap.

    What is fitted, and what the model's `effects` bring, is multiplied by a factor of its own,
    drawn evenly from 1 ± `perceive.drawn.machines`, and kept within its bounds; all else is as in
    `changes`.  The k-th machine depends on no other.
    """
    spread = config.perceive.drawn.machines
    brought = [f"{e.name()}.{f}" for e in effects for f in e.parameters()]
    names = [*config.identify.parameters, *brought]
    rng = np.random.default_rng([config.perceive.seed, MACHINES, k])
    factors = 1.0 + spread * rng.uniform(-1.0, 1.0, len(names))
    values = table.vector(changes)[[table.position(name) for name in names]]
    moved = np.clip(values * factors, *table.bounds(names))
    return {**changes, **dict(zip(names, moved.tolist(), strict=True))}
