"""Plays logs in an exported file of BAM, by the equations of its paper.

    J·a = τ_m + τ_e + τ_f,    τ_f = -sign(v)·(base + stribeck + |k_e·τ_e - k_m·τ_m|) - viscous·v
(Duclusaud, Passault, Padois, Ly, Extended friction models for servo actuators, 2024, eq. 4 to 9;
while it slides.)  BAM itself is not needed.
"""
# mypy: ignore-errors

import json

import numpy as np

PASSES = 60


def effort(told, given):
    """Control that each row needs."""
    v, a = given["speed"], given["acceleration"]
    external = -given["carried"] - given["hung"]
    sliding = told["friction_base"] + np.zeros_like(v)
    if "friction_stribeck" in told:
        slow = np.exp(-(np.abs(v / told["dtheta_stribeck"]) ** told["alpha"]))
        sliding += told["friction_stribeck"] * slow
    needed = told["armature"] * a - external + told["friction_viscous"] * v
    torque = needed.copy()
    for _ in range(PASSES):
        by_load = told.get("load_friction_external", 0.0) * external
        by_load = by_load - told.get("load_friction_motor", 0.0) * torque
        torque = needed + np.sign(v) * (sliding + np.abs(by_load))
    if told["actuator"].startswith("mx"):  # commanded in volts
        return told["R"] * torque / told["kt"] + told["kt"] * v
    return torque / told["kt"]


def play(folder, about, given):
    """Effort for each row; BAM has no frame that could be late."""
    (file,) = folder.glob(f"{about['name']}_m?.json")
    told = json.loads(file.read_text(encoding="utf-8"))
    return {"effort": effort(told, given), "framed": given["effort"]}
