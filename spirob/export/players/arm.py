"""Plays trials in an exported arm, beside plain MuJoCo.

Run apart from the project: python -I arm.py FOLDER GIVEN.npz RESULT.npz
"""
# mypy: ignore-errors

import argparse
import importlib.util
import json
from pathlib import Path

import mujoco
import numpy as np

STEPS = 2  # of the body in a cycle


def play(module, model, given, k):
    """Currents and lengths of a trial, (T, 2) each."""
    data, controller = mujoco.MjData(model), module.Controller(model, given[f"angle_{k}"])
    controller.start(model, data)
    controller.mode[:], controller.limit[:] = given[f"mode_{k}"], given[f"limit_{k}"]
    wanted, rates = given[f"reference_{k}"], given[f"rate_{k}"]
    current, length = np.zeros_like(wanted), np.zeros_like(wanted)
    for cycle in range(len(wanted)):
        controller.reference[:], controller.reference_rate[:] = wanted[cycle], rates[cycle]
        for step in range(STEPS):
            controller.before_step(model, data)
            if step == 0:
                current[cycle] = controller.read("current")
                length[cycle] = controller.read("displacement")
            mujoco.mj_step(model, data)
    return current, length


def main():
    """Play what is given and keep the result."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="that was exported to")
    parser.add_argument("given", type=Path, help="an .npz: logs to play")
    parser.add_argument("result", type=Path, help="an .npz: what was played")
    asked = parser.parse_args()
    folder, given = asked.folder, dict(np.load(asked.given))
    about = json.loads(str(given.pop("about")))
    spec = importlib.util.spec_from_file_location("exported", folder / f"{about['name']}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    model = mujoco.MjModel.from_xml_path(str(folder / f"{about['name']}.xml"))
    result = {}
    for k in range(about["trials"]):
        result[f"current_{k}"], result[f"length_{k}"] = play(module, model, given, k)
    np.savez(asked.result, **result)


if __name__ == "__main__":
    main()
