"""Plain MJCF: the body with its corrected numbers, and of the effects what MuJoCo holds itself."""

import math
import runpy
from pathlib import Path
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
CYCLE = 1e-3  # s
OWN, DAMPED = 2.0 * math.pi * 50.0, 1.0  # rad/s and damping ratio of a winch that is led


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


def trial(model, motors, length, rate, current, led, first):
    """Current that each cycle of an arm asks for, (T, 2): its drives lead the winches.

    Where a motor is commanded a current it gets it; where it follows something, a stiff spring and
    damper between the winch and its wanted place say which current the motion asks for.
    """
    import mujoco
    import numpy as np

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
    """Of an arm the currents of each trial; of a rig as `--to mujoco` is played."""
    if "trials" not in about:
        return runpy.run_path(str(Path(__file__).with_name("mujoco.py")))["play"](
            folder, about, given
        )
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(folder / f"{about['name']}.xml"))
    result = {}
    for k in range(about["trials"]):
        told = (given[f"{name}_{k}"] for name in ("length", "rate", "current", "led", "first"))
        result[f"current_{k}"] = trial(model, about["motors"], *told)
    return result
