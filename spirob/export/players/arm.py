"""Plays trials in an exported arm, beside plain MuJoCo."""
# mypy: ignore-errors

import importlib.util

import mujoco
import numpy as np

STEPS = 2  # of the body in a cycle


def trial(module, model, given, k):
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


def play(folder, about, given):
    """Currents and lengths of each trial."""
    spec = importlib.util.spec_from_file_location("exported", folder / f"{about['name']}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    model = mujoco.MjModel.from_xml_path(str(folder / f"{about['name']}.xml"))
    result = {}
    for k in range(about["trials"]):
        result[f"current_{k}"], result[f"length_{k}"] = trial(module, model, given, k)
    return result
