"""Effects that one rig cannot tell apart: their columns over its trials are the same.

Nothing is listed by name: two effects are equivalent on these data when one fitted in the place of
the other changes the modelled effort by less than the floor of an effect.
"""

from collections.abc import Sequence

import numpy as np

from spirob.machine.models import Model

ALIKE = 0.1  # of the floor: by no more may two models differ that say the same


def alike(one: Model, two: Model, least: float) -> bool:
    """Whether two models predict the same effort, within a tenth of the least effect's RMS."""
    difference = one.fit.residual - two.fit.residual
    return float(np.sqrt(np.mean(difference**2))) < ALIKE * least


def equivalents(
    chosen: Model, rivals: Sequence[Model], least: float
) -> tuple[list[str], list[str]]:
    """Names of the effects that say the same as the chosen one, and of those that are real rivals.

    A rival counts as itself once, though it may be met several times.
    """
    same: list[str] = []
    other: list[str] = []
    for rival in rivals:
        name = next(iter(rival.names - chosen.names))
        (same if alike(chosen, rival, least) else other).append(name)
    return sorted(set(same)), sorted(set(other) - set(same))
