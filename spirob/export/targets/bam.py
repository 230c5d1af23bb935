"""BAM (Rhoban's better actuator models): the JSON of its friction models, where they fit."""

import json
from typing import TYPE_CHECKING, Any

from spirob.errors import ExportError

if TYPE_CHECKING:
    from spirob.export.corrected import Corrected

HOLDS = "viscous, dry and Stribeck friction (M1, M2), and friction by the load (M3, M4)"
LACKS = "whatever is no friction, an arm, an axis that slides; the file states what that costs"
LOSSY = True
PLAYER = "bam"
KINDS = {(False, False): "m1", (True, False): "m2", (False, True): "m3", (True, True): "m4"}
# actuators of BAM that are commanded in the unit of the effort
ACTUATORS = {"A": "erob80_100", "V": "mx106"}
HELD = ("coulomb_friction", "stribeck_friction", "load_dependent_friction")


def files(model: "Corrected") -> dict[str, str]:
    """Name of each file -> its text."""
    from spirob.export.code import c_name
    from spirob.export.heldout import left_out

    if model.axis != "rad":
        raise ExportError(f"{model.name}: BAM's models are of servos that turn, this axis slides")
    told = parameters(model)
    outside = [e for e in model.effects if e.name not in HELD]
    told["of"] = model.sentence
    told["leaves_out"] = {e.name: left_out(model, e) for e in outside}
    name = f"{c_name(model.name)}_{told['model']}.json"
    return {name: json.dumps(told, indent=2, ensure_ascii=False) + "\n"}


def parameters(model: "Corrected") -> dict[str, Any]:
    """The numbers under BAM's names.

    BAM's friction by the load follows |τ_external - τ_motor|, which is twice a load that is held
    and once one that is accelerated; here it is taken for the latter.
    """
    by_name = {e.name: e.values for e in model.effects if e.name in HELD}
    coulomb = by_name.get("coulomb_friction", {})
    stribeck, load = by_name.get("stribeck_friction"), by_name.get("load_dependent_friction")
    numbers = model.numbers
    told: dict[str, Any] = {
        "model": KINDS[stribeck is not None, load is not None],
        "actuator": ACTUATORS.get(model.effort, ACTUATORS["A"]),
        **_motor(model),
        "armature": numbers["inertia"],
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
        told["load_friction_base"] = load["loss_ratio"]
        if stribeck is not None:
            told["load_friction_stribeck"] = 0.0
    return told


def _motor(model: "Corrected") -> dict[str, float]:
    """Torque constant and resistance."""
    scale, back_emf = model.numbers["scale"], model.numbers["back_emf"]
    if model.effort != "V":
        return {"kt": scale, "R": 1.0}
    if not (scale > 0.0 and back_emf > 0.0):
        raise ExportError(
            f"{model.name}: BAM tells a voltage by torque constant and resistance; fit 'back_emf'"
        )
    return {"kt": back_emf, "R": back_emf / scale}
