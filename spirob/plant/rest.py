"""Where the arm hangs before a trial: at rest, tendons off.

Lengths count from there, as the tendons of a robot are taken up on the arm as it hangs.  A weight
across the arm or a bend of its own moves that pose by many degrees: begun straight, a trial would
open with a swing that no robot makes.  The pose is found by letting the calm arm relax, its hinges
damped far more than they are, against end stops and against itself.
"""

import copy
from collections.abc import Sequence

import mujoco
import numpy as np

from spirob.effects import Effect
from spirob.plant.body import hinge_weights

DAMPING = 0.6  # s, over the stiffness: the slowest mode of the arm is then nearly critical
STEP = 4e-3  # s
ROUND = 25  # steps between two looks at the effects' torques
ROUNDS = 100  # at most: 10 s
STILL = 1e-9  # rad/s

# an effect's kernel with its numbers
Torque = tuple[type[Effect], tuple[tuple[str, float], ...]]


def rest_pose(
    model: mujoco.MjModel, units: np.ndarray, stiffness: np.ndarray, torques: Sequence[Torque]
) -> np.ndarray:
    """Angles of the hinges at rest [rad], (N,).

    model      of the arm without anything to touch
    units      (N + 1, 2) mass [kg] and length [m] of each unit, the mass at the tip last
    stiffness  of the hinges [N·m/rad], (N,)
    torques    effects that turn hinges, without memory
    """
    hinges = len(stiffness)
    calm = copy.copy(model)
    calm.opt.timestep = STEP
    calm.dof_damping[:hinges] = DAMPING * stiffness
    data = mujoco.MjData(calm)
    weight = np.zeros((hinges, 2))
    for _ in range(ROUNDS):
        hinge_weights(data.qpos, units, weight)
        signals = {
            "hinge.angle": data.qpos,
            "hinge.speed": np.zeros(hinges),
            "hinge.stiffness": stiffness,
            "hinge.weight_x": weight[:, 0],
            "hinge.weight_y": weight[:, 1],
        }
        data.qfrc_applied[:hinges] = sum(_torque(t, signals, hinges) for t in torques)
        mujoco.mj_step(calm, data, ROUND)
        if np.abs(data.qvel).max() < STILL:
            break
    return np.array(data.qpos[:hinges])


def _torque(torque: Torque, signals: dict[str, np.ndarray], hinges: int) -> np.ndarray:
    effect, numbers = torque
    values = dict(numbers)
    return np.array(
        [
            effect.kernel(**{a: signals[s][i] for a, s in effect.reads.items()}, **values)
            for i in range(hinges)
        ]
    )
