"""The baseline: robot dynamics alone, without motor, winch or elastic tendon.

The commanded tendon forces act on the body in the cycle in which they are commanded (paper eq.
continuumdynamics with F = F_cmd), so it answers at once where the coupled model lags.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from spirob.errors import SimulationError
from spirob.plant.body import build_spec
from spirob.plant.objects import launch
from spirob.plant.plant import CYCLE, SUBSTEPS
from spirob.plant.rig import Rig
from spirob.robot import MOTORS, Scene


@dataclass(frozen=True)
class Motion:
    """What the arm did; row k is the state at the start of cycle k.

    shortening       (T, 2) Δl of the left and right tendon [m];  shortening_rate [m/s]
    angles           (T, N) hinge angles [rad]
    """

    shortening: np.ndarray
    shortening_rate: np.ndarray
    angles: np.ndarray


def single_dynamics(
    rig: Rig, force: np.ndarray, scene: Scene | None = None, substeps: int = SUBSTEPS
) -> Motion:
    """Pull the arm with commanded tendon forces, from rest.

    force  (T, 2) [N] of the left and right tendon, one row for each 1 kHz cycle; a negative one
           counts as zero, because a tendon does not push
    Raises SimulationError naming the time at which a state becomes non-finite.
    """
    step = CYCLE / substeps
    spec = build_spec(rig.arm, scene or Scene(), rig.lengths(), step, True, holes=rig.holes)
    model = spec.compile()
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    data = mujoco.MjData(model)
    launch(data, scene or Scene(), rig.units)
    mujoco.mj_forward(model, data)
    rest = data.ten_length.copy()
    cycles = len(force)
    shortening, rate = np.zeros((cycles, len(MOTORS))), np.zeros((cycles, len(MOTORS)))
    angles = np.zeros((cycles, rig.units))
    for k in range(cycles):
        shortening[k], rate[k] = rest - data.ten_length, -data.ten_velocity
        angles[k] = data.qpos[: rig.units]
        data.ctrl[:] = np.maximum(force[k], 0.0)
        mujoco.mj_step(model, data, nstep=substeps)
        # lengths belong to the step's beginning; bring them to its end
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        if not np.isfinite(data.qvel).all():
            raise SimulationError(f"the arm became non-finite after {k * CYCLE:.3f} s")
    return Motion(shortening, rate, angles)
