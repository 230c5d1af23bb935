"""Plays trials in the plain MJCF of an arm: its drives lead the tendons as they are told to move.

Where a motor is commanded a current it gets it; where it follows something, a stiff spring and
damper between the tendon and its wanted length say which current the motion asks for.

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
OWN, DAMPED = 2.0 * math.pi * 50.0, 1.0  # rad/s and damping ratio of a tendon that is led


def play(model, motors, length, rate, current, led):
    """Current that each cycle asks for, (T, 2)."""
    data, found = mujoco.MjData(model), current.copy()
    tendons = [model.tendon(m).id for m in motors]
    drives = [model.actuator(m).id for m in motors]
    gain = model.actuator_gainprm[drives, 0]
    moved = model.tendon_armature[tendons]
    steps = round(CYCLE / model.opt.timestep)
    mujoco.mj_forward(model, data)
    rest = data.ten_length[tendons].copy()
    bend = np.gradient(rate, CYCLE, axis=0)
    for cycle in range(len(length)):
        for step in range(steps):
            t = step * model.opt.timestep
            off = length[cycle] + t * rate[cycle] - (rest - data.ten_length[tendons])
            slow = rate[cycle] + t * bend[cycle] + data.ten_velocity[tendons]
            force = moved * (bend[cycle] + OWN * (OWN * off + 2.0 * DAMPED * slow))
            asked = np.where(led, force / gain, current[cycle])
            if step == 0:
                found[cycle] = asked
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
        told = (given[f"{name}_{k}"] for name in ("length", "rate", "current", "led"))
        result[f"current_{k}"] = play(model, about["motors"], *told)
    np.savez(asked.result, **result)


if __name__ == "__main__":
    main()
