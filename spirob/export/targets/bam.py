"""BAM (Rhoban's better actuator models): the JSON of its friction models, where they fit."""

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from spirob.export.arm import CorrectedArm
    from spirob.export.corrected import Corrected

HOLDS = (
    "viscous, dry and Stribeck friction (M1, M2), and friction by the load (M5); of an arm each "
    "motor by itself"
)
LACKS = "whatever is no friction, an axis that slides; the file states what that costs"
LOSSY = True
FAST = 1.0  # rad/s: BAM divides by a Stribeck speed, also where there is no such friction
# actuators of BAM that are commanded in the unit of the effort
ACTUATORS = {"A": "erob80_100", "V": "mx106"}
PASSES = 60
HELD = ("coulomb_friction", "stribeck_friction", "load_dependent_friction")


def arm(model: "CorrectedArm") -> dict[str, str]:
    """The same of an arm: each motor as a servo in rotor coordinates."""
    from spirob.export.arm import motor_of
    from spirob.robot import MOTORS

    return {name: text for motor in MOTORS for name, text in files(motor_of(model, motor)).items()}


def files(model: "Corrected") -> dict[str, str]:
    """Name of each file -> its text."""
    from spirob.errors import ExportError
    from spirob.export.code import c_name
    from spirob.export.heldout import left_out

    if model.axis != "rad":
        raise ExportError(f"{model.name}: BAM's models are of servos that turn, this axis slides")
    told = parameters(model)
    outside = [e for e in model.effects if e.name not in HELD]
    told["of"] = model.sentence
    told["leaves_out"] = {e.name: left_out(model, e) for e in outside}
    if model.numbers["stiffness"]:
        told["leaves_out"]["stiffness"] = "BAM has no spring: give it to your body"
    name = f"{c_name(model.name)}_{told['model']}.json"
    return {name: json.dumps(told, indent=2, ensure_ascii=False) + "\n"}


def parameters(model: "Corrected") -> dict[str, Any]:
    """The numbers under BAM's names.

    Friction by the load is M5's, |k_e·τ_external - k_m·τ_motor|, with k_m alone: a motor's torque
    is the load, held or accelerated, and the friction itself.  That is wrong by the share m of the
    load that is lost, 1/(1 - m) while driving and 1/(1 + m) while driven; M3 and M4 count a held
    load twice.  An M6 is an M5 with squares of the load, which no law here has.
    """
    by_name = {e.name: e.values for e in model.effects if e.name in HELD}
    coulomb = by_name.get("coulomb_friction", {})
    stribeck, load = by_name.get("stribeck_friction"), by_name.get("load_dependent_friction")
    numbers = model.numbers
    told: dict[str, Any] = {
        "model": "m5" if load else "m2" if stribeck else "m1",
        "actuator": ACTUATORS.get(model.effort, ACTUATORS["A"]),
        **_motor(model),
        "armature": numbers["inertia"] + model.own_inertia,
        "q_offset": 0.0,
        "command_delay": max(0.0, numbers["delay"]),
        "friction_base": coulomb.get("coulomb_torque", 0.0),
        "friction_viscous": numbers["viscous"],
    }
    if stribeck is not None:
        told["friction_base"] += stribeck["coulomb_torque"]
        told["friction_stribeck"] = stribeck["breakaway_excess"]
        told["dtheta_stribeck"] = stribeck["stribeck_ratio"] * model.rest_speed
        told["alpha"] = 2.0
    if load is not None:
        told = {"friction_stribeck": 0.0, "dtheta_stribeck": FAST, "alpha": 2.0} | told
        told["load_friction_motor"] = load["loss_ratio"]
        for other in ("external", "motor_stribeck", "external_stribeck"):
            told[f"load_friction_{other}"] = 0.0
    return told


def _motor(model: "Corrected") -> dict[str, float]:
    """Torque constant and resistance."""
    from spirob.errors import ExportError

    scale, back_emf = model.numbers["scale"], model.numbers["back_emf"]
    if model.effort != "V":
        return {"kt": scale, "R": 1.0}
    if not (scale > 0.0 and back_emf > 0.0):
        raise ExportError(
            f"{model.name}: BAM tells a voltage by torque constant and resistance; fit 'back_emf'"
        )
    return {"kt": back_emf, "R": back_emf / scale}


def effort(told, given):
    """Control that each row needs, by the equations of BAM's paper.

        J·a = τ_m + τ_e + τ_f,   τ_f = -sign(v)·(base + stribeck + |k_e·τ_e - k_m·τ_m|) - viscous·v
    (Duclusaud, Passault, Padois, Ly, Extended friction models for servo actuators, 2024, eq. 4 to
    9; while it slides.)  BAM itself is not needed.
    """
    import numpy as np

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
