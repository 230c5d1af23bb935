"""The arm in plain MJCF: its body, two winches on springy tendons, drives in ampere.

A winch is a slide that pulls the tendon's end away from its first guide: position x is the tendon
wound in [m], mass (G²·J_r + J_d)/r².  The tendon is a spring from its length at rest on, so it
stretches under load, and goes slack instead of pushing.
"""

from collections.abc import Callable
from dataclasses import replace

import mujoco
import numpy as np

from spirob.effects import Effect
from spirob.export.arm import CorrectedArm, lever_of, motor_of, number_of
from spirob.export.body import Machine
from spirob.export.native import HOLDERS
from spirob.plant.body import build_spec
from spirob.plant.plant import CYCLE, SUBSTEPS
from spirob.robot import MOTORS, Scene

AWAY = np.array([-1.0, 0.0, 0.0])  # from the base, where a winch pulls
ROOM = 0.5  # m, between a winch and the base
AT_A_WINCH = {"motor.torque", "tendon.force", "sensing.current"}
POWERS = {"N": 1, "N·m": 1, "rad": -1, "N·m·s²/rad²": 3}  # of rotor radians for a metre, by unit
Number = Callable[..., float]


def with_tendons(
    model: CorrectedArm,
) -> tuple[Machine, list[str], dict[str, dict[str, float]]]:
    """The body with winches and tendons, names of effects that it holds, and what it leaves out.

    The last with the numbers that it has instead: tendons bend at a hinge once, effects are absent.
    """
    plant = model.plant()
    p = plant.table.vector(model.changes)
    arm, step, tip = plant.arm(p), CYCLE / SUBSTEPS, plant.tip_mass(p)
    spec = build_spec(arm, Scene(), model.rig.lengths(), step, True, tip, plant.holes(p))
    for motor in MOTORS:
        _winch(spec, motor, number_of(model, motor))
    held, outside = list[str](), dict[str, dict[str, float]]()
    if arm.bends_per_hinge != 1.0:
        outside["arm.bends_per_hinge"] = {"arm.bends_per_hinge": 1.0}
    for effect in model.effects:
        name = effect.name()
        if _held(spec, effect, model):
            held.append(name)
        else:
            outside[name] = {f"{name}.{f}": v for f, v in effect.neutral.items()}
    begun = plant.start(Scene(), model.changes).constants()["qpos"]
    _at_rest(spec, np.asarray(begun))
    return Machine(spec, "hinge_0", ""), held, outside


def _winch(spec: mujoco.MjSpec, motor: str, number: Number) -> None:
    """A slide with the rotor's inertia and friction, its drive, and the tendon's end on it."""
    turn = number("winch.gear_ratio") / number("winch.radius", True)  # rad of the rotor for a metre
    rotor = number("motor.rotor_inertia", True) * turn**2
    drum = number("winch.drum_inertia") / number("winch.radius", True) ** 2
    first = spec.site(f"{motor}_before_0")
    body = spec.worldbody.add_body(name=f"{motor}_winch", pos=first.pos + ROOM * AWAY)
    body.explicitinertial, body.mass, body.inertia = True, rotor + drum, np.full(3, 1e-3)
    body.ipos = [0.0, 0.0, 0.0]
    body.add_site(name=f"{motor}_winch")
    slide = body.add_joint(name=f"{motor}_winch", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=AWAY)
    slide.damping = [turn**2 * number("motor.rotor_damping", True), 0.0, 0.0]
    spec.delete(spec.actuator(motor))
    drive = spec.add_actuator(
        name=motor, target=f"{motor}_winch", trntype=mujoco.mjtTrn.mjTRN_JOINT
    )
    efficiency = number("winch.efficiency", True)
    drive.gainprm[0] = efficiency * turn * number("motor.torque_constant")
    path = [wrap.target.name for wrap in spec.tendon(motor).path]
    spec.delete(spec.tendon(motor))
    tendon = spec.add_tendon(name=motor)
    for site in (f"{motor}_winch", *path):
        tendon.wrap_site(site)
    tendon.stiffness = [number("tendon.stiffness"), 0.0, 0.0]
    tendon.damping = [number("tendon.damping"), 0.0, 0.0]


def _at_rest(spec: mujoco.MjSpec, angles: np.ndarray) -> None:
    """Tendons that are just taut where the arm hangs, and a keyframe there; angles (N,) [rad]."""
    made = spec.compile()
    data = mujoco.MjData(made)
    for k, angle in enumerate(angles):
        data.joint(f"hinge_{k}").qpos[0] = angle
    mujoco.mj_fwdPosition(made, data)
    for motor in MOTORS:
        spec.tendon(motor).springlength = [0.0, float(data.tendon(motor).length[0])]
    spec.add_key(name="rest", qpos=data.qpos)


def _held(spec: mujoco.MjSpec, effect: type[Effect], model: CorrectedArm) -> bool:
    """Put an effect into the model, where MuJoCo can hold it."""
    name, number = effect.name(), number_of(model, MOTORS[0])
    hinges = [spec.joint(f"hinge_{k}") for k in range(model.rig.units)]
    if name == "stiffness_hardening":
        for hinge in hinges:
            stiffness = float(hinge.stiffness[0])
            hinge.stiffness = [stiffness, 0.0, number(f"{name}.hardening") * stiffness]
    elif name == "rest_curvature":
        for hinge in hinges:
            hinge.springref = number(f"{name}.rest_angle")
    elif name == "mount_tilt":
        turned = [np.sin(number(f"{name}.{field}")) for field in ("pitch", "roll")]
        spec.option.gravity = spec.option.gravity + 9.80665 * np.array([*turned, 0.0])
    elif (name, effect.port) in HOLDERS and effect.port in AT_A_WINCH:
        for motor in MOTORS:
            _at_winch(spec, effect, model, motor)
    else:
        return name == "tip_payload"  # the body was built with it
    return True


def _at_winch(spec: mujoco.MjSpec, effect: type[Effect], model: CorrectedArm, motor: str) -> None:
    """An effect of the rotor, in metres of the tendon instead of radians."""
    axis, turn = motor_of(model, motor), 1.0 / lever_of(model, motor)
    axis = replace(axis, angle=1.0 / turn, rest_speed=axis.rest_speed / turn)
    (one,) = (e for e in axis.effects if e.name == effect.name())
    about = effect.parameters()
    values = {f: v * turn ** POWERS.get(about[f].unit, 0) for f, v in one.values.items()}
    machine = Machine(spec, f"{motor}_winch", "", motor)
    HOLDERS[effect.name(), effect.port](machine, replace(one, values=values), axis)
