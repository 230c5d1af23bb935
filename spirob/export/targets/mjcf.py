"""Plain MJCF: the body with its corrected numbers, and of the effects what MuJoCo holds itself."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from spirob.export.arm import CorrectedArm
    from spirob.export.corrected import Corrected

HOLDS = (
    "armature, damping, friction loss, polynomial stiffness and drag, LuGre bristles, cogging, "
    "payload, tilt, forces, current gain and offset, sensors that lag or are late, a second joint "
    "for an elastic gear or creeping material; an arm's winches and springy tendons"
)
LACKS = (
    "what needs a callback: friction by load, efficiency, ripple, saturation, dead band, heat, "
    "errors of the encoder, asymmetric friction, play; each is listed in the file with its size"
)
LOSSY = True
PLAYER = "mjcf"


def arm(model: "CorrectedArm") -> dict[str, str]:
    """The same of an arm: its body, two winches on springy tendons, drives in ampere."""
    from spirob.export.arm_mujoco import with_tendons
    from spirob.export.code import c_name
    from spirob.export.heldout import arm_left_out

    machine, held, outside = with_tendons(model)
    name = c_name(model.name)
    said = [f"{name}.xml: {model.sentence}"]
    said += ["controls: current of each drive [A], positive winds in; keyframe: at rest"]
    said += [f"holds {e}" for e in held]
    costs = arm_left_out(model, outside)
    said += [f"leaves out {name}: {cost}" for name, cost in costs.items()]
    return {f"{name}.xml": machine.text(said)}


def files(model: "Corrected") -> dict[str, str]:
    """Name of each file -> its text."""
    from spirob.export.body import DRIVE, machine_of
    from spirob.export.code import c_name
    from spirob.export.heldout import left_out
    from spirob.export.native import READING, holder, usual

    machine, name = machine_of(model), c_name(model.name)
    usual(machine, model)
    held = [e for e in model.effects if holder(e, model)]
    outside = [e for e in model.effects if not holder(e, model)]
    for one in held:
        if hold := holder(one, model):
            hold(machine, one, model)
    said = [f"{name}.xml: {model.sentence}"]
    said += [f"holds {e.name}" for e in held]
    said += [f"leaves out {e.name}: {left_out(model, e)}" for e in outside]
    if machine.spec.actuator(READING):
        said.append(f"give '{READING}' the control of '{DRIVE}'; effort, position: the log")
    if model.numbers["delay"]:
        said.append(f"the log trails the motion by {1e3 * model.numbers['delay']:.3g} ms: not here")
    return {f"{name}.xml": machine.text(said)}
