"""Whether a model's figure lies within a share of the robot's, as far as noise lets one tell.

Both figures are means over plays and have a standard error each.  With r = model/robot,

    |r - 1| + 2σ_r <= share   within        |r - 1| - 2σ_r > share   beyond

and what lies nearer to the border than that is not settled.
"""

from dataclasses import dataclass

import numpy as np

SURE = 2.0  # standard errors
WITHIN, BEYOND, OPEN = "within", "beyond", "not settled"


@dataclass(frozen=True)
class Figure:
    """A figure and its standard error, in the same unit; NaN where it has none."""

    value: float
    error: float


def off(model: Figure, robot: Figure) -> Figure:
    """By which share of the robot's a model's figure is off: r - 1, with its sign."""
    ratio = model.value / robot.value
    error = np.hypot(model.error, ratio * robot.error) / abs(robot.value)
    return Figure(ratio - 1.0, float(error))


def compared(model: Figure, robot: Figure, share: float) -> str:
    """`WITHIN`, `BEYOND`, or `OPEN`."""
    apart = off(model, robot)
    doubt = SURE * apart.error
    if abs(apart.value) + doubt <= share:
        return WITHIN
    return BEYOND if abs(apart.value) - doubt > share else OPEN


def percent(share: Figure) -> str:
    """As text, its standard error behind it."""
    return f"{share.value:+.1%} ± {share.error:.1%}"
