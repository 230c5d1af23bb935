"""How far a model's current is off the robot's, in one motion and each in its own.

When a detector speaks and what a current is are two questions.  In one motion the model moves as
the robot did and recoils when it did.  Each in its own, a recoil that comes at another time counts
as error; there the robot is played several times, and its plays against each other say how much of
such an error is its own.
"""

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from spirob.experiments.experiment import Side, repeating, row

PAPER_RMSE = 0.307  # A, filtered
AIM_RMSE = 0.1  # A
MODELS = ("base", "named")


def rmse(one: np.ndarray, other: np.ndarray) -> float:
    """Root of the mean squared difference, up to the end of the shorter one."""
    both = min(len(one), len(other))
    return float(np.sqrt(np.mean((one[:both] - other[:both]) ** 2)))


def in_one_motion(
    what: str, played: Mapping[str, Side], signal: str, motor: int, recoils: bool
) -> dict[str, Any]:
    """Row of the RMSE [A] of models that moved as the robot did.

    played   side -> what it did;  signal  `current` or `filtered`
    recoils  whether the trial has a recoil; else the models' own motion is the robot's
    """
    errors = {}
    for model in MODELS:
        side = played.get(repeating(model) if recoils else model)
        if side is not None and "robot" in played:
            errors[model] = _between(side, played["robot"], signal, motor)
    note = "the model moves as the robot did and recoils when it did" if recoils else ""
    return _aimed(what, errors, note, PAPER_RMSE if recoils else None)


def each_in_its_own(
    what: str, robots: Sequence[Side], models: Mapping[str, Side], signal: str, motor: int
) -> dict[str, Any]:
    """Row of the mean RMSE [A] over the robot's plays of one trial; of the robot, over their pairs.

    What two plays of one robot differ by is no model's fault.
    """
    errors = {
        m: _mean([_between(models[m], robot, signal, motor) for robot in robots])
        for m in MODELS
        if m in models and robots
    }
    pairs = [_between(one, other, signal, motor) for one, other in combinations(robots, 2)]
    note = "to the end of the shorter; a recoil at another time counts as error"
    if pairs:
        errors["robot"] = _mean(pairs)
        note = f"{note}; mean over {len(robots)} plays of the robot, its own against each other"
    return _aimed(what, errors, note, None)


def _between(one: Side, other: Side, signal: str, motor: int) -> float:
    return rmse(one.driven(signal, motor), other.driven(signal, motor))


def _mean(errors: Sequence[float]) -> float:
    return float(np.mean(errors))


def _aimed(
    what: str, errors: Mapping[str, float], note: str, paper: float | None
) -> dict[str, Any]:
    met = bool(errors["named"] <= AIM_RMSE) if "named" in errors else None
    return row(what, "A", errors, paper=paper, aim=f"at most {AIM_RMSE} A", met=met, note=note)
