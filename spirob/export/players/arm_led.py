"""Plays trials in the plain MJCF of an arm: its drives lead the winches as they are told to move.

Where a motor is commanded a current it gets it; where it follows something, a stiff spring and
damper between the winch and its wanted place say which current the motion asks for.
"""
# mypy: ignore-errors

import math

import mujoco
import numpy as np

CYCLE = 1e-3  # s
OWN, DAMPED = 2.0 * math.pi * 50.0, 1.0  # rad/s and damping ratio of a winch that is led


def trial(model, motors, length, rate, current, led, first):
    """Current that each cycle asks for, (T, 2)."""
    data, found = mujoco.MjData(model), current.copy()
    joints = [model.joint(f"{m}_winch") for m in motors]
    places = [int(j.qposadr[0]) for j in joints]
    dofs = [int(j.dofadr[0]) for j in joints]
    drives = [model.actuator(m).id for m in motors]
    gain, moved = model.actuator_gainprm[drives, 0], 1.0 / model.dof_invweight0[dofs]
    steps = round(CYCLE / model.opt.timestep)
    model.qpos0[places] = first  # rotors do not begin where their angle is zero
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.qpos[places] = first
    bend = np.gradient(rate, CYCLE, axis=0)
    asked = current[0]
    for cycle in range(len(length)):
        found[cycle] = asked  # a reading at the start of a cycle is what acted until then
        for step in range(steps):
            t = step * model.opt.timestep
            off = length[cycle] + t * rate[cycle] + first - data.qpos[places]
            slow = rate[cycle] + t * bend[cycle] - data.qvel[dofs]
            force = moved * (bend[cycle] + OWN * (OWN * off + 2.0 * DAMPED * slow))
            asked = np.where(led, force / gain, current[cycle])
            data.ctrl[drives] = asked
            mujoco.mj_step(model, data)
    return found


def play(folder, about, given):
    """Currents of each trial."""
    model = mujoco.MjModel.from_xml_path(str(folder / f"{about['name']}.xml"))
    result = {}
    for k in range(about["trials"]):
        told = (given[f"{name}_{k}"] for name in ("length", "rate", "current", "led", "first"))
        result[f"current_{k}"] = trial(model, about["motors"], *told)
    return result
