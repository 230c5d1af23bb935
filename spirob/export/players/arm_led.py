"""Plays trials in the plain MJCF of an arm: its drives lead the winches as they are told to move.

Where a motor is commanded a current it gets it; where it follows something, a stiff spring and
damper between the winch and its wanted place say which current the motion asks for.

Run apart from the project: python -I arm_led.py FOLDER GIVEN.npz RESULT.npz
"""
# mypy: ignore-errors

import argparse
import json
import math
from pathlib import Path

import mujoco
import numpy as np

CYCLE = 1e-3  # s
OWN, DAMPED = 2.0 * math.pi * 50.0, 1.0  # rad/s and damping ratio of a winch that is led


def play(model, motors, length, rate, current, led, first):
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


def main():
    """Play what is given and keep the result."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="that was exported to")
    parser.add_argument("given", type=Path, help="an .npz: logs to play")
    parser.add_argument("result", type=Path, help="an .npz: what was played")
    asked = parser.parse_args()
    given = dict(np.load(asked.given))
    about = json.loads(str(given.pop("about")))
    model = mujoco.MjModel.from_xml_path(str(asked.folder / f"{about['name']}.xml"))
    result = {}
    for k in range(about["trials"]):
        told = (given[f"{name}_{k}"] for name in ("length", "rate", "current", "led", "first"))
        result[f"current_{k}"] = play(model, about["motors"], *told)
    np.savez(asked.result, **result)


if __name__ == "__main__":
    main()
