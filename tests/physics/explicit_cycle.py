"""The paper's cycle coded literally: the previous cycle's acceleration in this cycle's force.

    F_cmd(t_k) = (τ_eq(t_k) - J_eq θ̈_out(t_(k-1)) - b_eq θ̇_out(t_(k-1)))/r        (eq. F_cmd_tk)

Kept as a reference only, to show when it diverges.
"""

import mujoco
import numpy as np

from spirob.plant.body import build_spec
from spirob.robot import Scene

STEP = 5e-4
ABSURD = 1e3  # N, of 0.2 N asked for; beyond, the arm has folded into itself, which may hold it


def explicit_cycle(rig, torque, duration, smoothing=0.0):
    """Pull the left tendon with a constant torque at the drum [N·m]; until when it stays finite.

    smoothing  of θ̈ by a first-order low pass: 0 none, 0.99 strong
    Returns (time of divergence [s] or None, rate of the tendon by step [m/s]).
    """
    model = build_spec(rig.arm, Scene(), rig.lengths(), STEP, tendons=True).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    square = (rig.winch.gear_ratio / rig.winch.radius) ** 2
    inertia, damping = square * rig.motor.rotor_inertia, square * rig.motor.rotor_damping
    accel = before = 0.0
    rates = []
    for k in range(round(duration / STEP)):
        rate = -data.ten_velocity[0]
        accel = smoothing * accel + (1.0 - smoothing) * (rate - before) / STEP
        before = rate
        force = torque / rig.winch.radius - inertia * accel - damping * rate
        if not abs(force) < ABSURD:
            return k * STEP, np.array(rates)
        data.ctrl[0] = force
        mujoco.mj_step(model, data)
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        rates.append(rate)
    return None, np.array(rates)


def tendon_inertia(rig):
    """1/(J M⁻¹ Jᵀ) of the straight arm at the left tendon [kg]."""
    model = build_spec(rig.arm, Scene(), rig.lengths(), STEP, tendons=True).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    pull = np.zeros((1, model.nv))
    data.ctrl[0] = 1.0
    mujoco.mj_forward(model, data)
    pull[0] = data.qfrc_actuator
    solved = np.zeros_like(pull)
    mujoco.mj_solveM(model, data, solved, pull)
    return 1.0 / float(pull[0] @ solved[0])
