"""Regimes of the arm that its drives do not see: a slack tendon, the end stop, an object near by.

The model that is judged says when: its tendons' tension and its hinges' angles.
"""

from collections.abc import Mapping

import numpy as np

from spirob.diagnosis.regimes import Masks
from spirob.identify.residual import Residual

SLACK = 0.05  # N: a tendon that pulls less moves nothing
CLOSED = 0.99  # of the end stop's angle: neighbouring units touch


def situations(residual: Residual, changes: Mapping[str, float]) -> list[dict[str, Masks]]:
    """Of each stretch of the residual: kind -> regime -> (N,) whether a sample belongs to it.

    changes  numbers of the model that says where the arm is
    """
    found = []
    limit = residual.plant.rig.arm.limit_ratio * residual.plant.geometry.hinge_angle
    for k, trial in enumerate(residual.trials):
        response = residual.respond(changes, k)
        cycles = residual.cycles(trial)
        slack = response.tension[cycles] < SLACK
        closed = (np.abs(response.angles[cycles]) > CLOSED * limit).any(axis=1)
        for motor in residual.driven(trial):
            contact = {"curled to the end stop": closed}
            if trial.scene.touchable:
                contact["an object within reach"] = np.ones(len(closed), dtype=bool)
            pulls = {
                "pulling tendon slack": slack[:, motor],
                "antagonist slack": np.delete(slack, motor, axis=1).any(axis=1),
            }
            found.append({"slack": pulls, "contact": contact})
    return found
