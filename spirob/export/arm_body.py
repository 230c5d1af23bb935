"""The arm's body as a MuJoCo model: bare for the coupled loop, or with tendons and drives."""

import mujoco
import numpy as np

from spirob.effects import Effect
from spirob.export.arm import CorrectedArm
from spirob.export.body import Machine
from spirob.plant.body import build_spec
from spirob.plant.plant import CYCLE, SUBSTEPS
from spirob.robot import MOTORS, Scene


def bare(model: CorrectedArm) -> Machine:
    """The body alone, with the payload that was named, stepped as the model here is."""
    plant = model.plant()
    p = plant.table.vector(model.changes)
    spec = build_spec(
        plant.arm(p), Scene(), model.rig.lengths(), CYCLE / SUBSTEPS, tip_mass=plant.tip_mass(p)
    )
    return Machine(spec, "hinge_0", "")


def with_tendons(model: CorrectedArm) -> tuple[Machine, list[str], list[str]]:
    """The body with tendons and drives in ampere; names of effects that it holds, and of others."""
    plant = model.plant()
    p = plant.table.vector(model.changes)

    def number(name: str) -> float:
        return float(p[plant.table.position(name)])

    holes = plant.holes(p)
    tip = plant.tip_mass(p)
    units = model.rig.units
    spec = build_spec(
        plant.arm(p), Scene(), model.rig.lengths(), CYCLE / SUBSTEPS, True, tip, holes
    )
    gear, radius = number("winch.gear_ratio"), number("winch.radius")
    for side, motor in zip((1.0, -1.0), MOTORS, strict=True):
        share = {n: 1.0 + side * number(f"{n}_difference") for n in DIFFERING}
        turn = gear / (radius * share["winch.radius"])  # rad of the rotor for one metre
        tendon, drive = spec.tendon(motor), spec.actuator(motor)
        rotor = number("motor.rotor_inertia") * share["motor.rotor_inertia"]
        tendon.armature = turn**2 * (rotor + number("winch.drum_inertia") / gear**2)
        tendon.damping = [
            turn**2 * number("motor.rotor_damping") * share["motor.rotor_damping"],
            0.0,
            0.0,
        ]
        efficiency = number("winch.efficiency") * share["winch.efficiency"]
        drive.gainprm[0] = efficiency * turn * number("motor.torque_constant")
    held, outside = list[str](), list[str]()
    for effect in model.effects:
        values = {f: number(f"{effect.name()}.{f}") for f in effect.parameters()}
        done = _held(spec, effect, values, gear / radius, units)
        (held if done else outside).append(effect.name())
    return Machine(spec, "hinge_0", ""), held, outside


DIFFERING = ("motor.rotor_inertia", "motor.rotor_damping", "winch.efficiency", "winch.radius")


def _held(
    spec: mujoco.MjSpec, effect: type[Effect], values: dict[str, float], turn: float, units: int
) -> bool:
    """Put an effect into the model, where MuJoCo can hold it."""
    hinges = [spec.joint(f"hinge_{k}") for k in range(units)]
    name = effect.name()
    if name == "stiffness_hardening":
        for hinge in hinges:
            stiffness = float(hinge.stiffness[0])
            hinge.stiffness = [stiffness, 0.0, values["hardening"] * stiffness]
    elif name == "rest_curvature":
        for hinge in hinges:
            hinge.springref = values["rest_angle"]
    elif name == "mount_tilt":
        more = 9.80665 * np.array([np.sin(values["pitch"]), np.sin(values["roll"]), 0.0])
        spec.option.gravity = spec.option.gravity + more
    elif name == "coulomb_friction":
        for motor in MOTORS:
            spec.tendon(motor).frictionloss = turn * values["coulomb_torque"]
    elif name == "constant_force":
        for motor in MOTORS:
            drive = spec.actuator(motor)
            drive.biastype = mujoco.mjtBias.mjBIAS_AFFINE
            drive.biasprm[0] = values["force"]
    else:
        return name == "tip_payload"  # the body was built with it
    return True
