"""What MuJoCo holds by itself: an effect -> attributes and passive actuators of the model.

`HOLDERS` has an entry for each law, by name and port; a law without one stays outside.
"""

import math
from collections.abc import Callable

import mujoco
import numpy as np

from spirob.export.body import STEP, Machine, weigh
from spirob.export.corrected import Corrected, Held

NO_MOTOR = 1e-9  # constant of a dcmotor that drives nothing and brakes nothing
RAMP = 1.35  # of a clipped line that is as near to tanh as can be, in units of its speed
SOFT = 1e-4  # impedance of a friction constraint that is a ramp of the speed
SWING = 2e-4  # s, of a step: MuJoCo's error is of first order in it
READING = "reading"
LIGHT = 1e-7  # kg·m², of a joint that only creeps
Holder = Callable[[Machine, Held, Corrected], None]


def _passive(machine: Machine, name: str, **what: object) -> None:
    """A dcmotor that drives nothing, for its cogging or its bristles."""
    motor = machine.spec.add_actuator(
        name=f"{machine.joint}_{name}", target=machine.joint, trntype=mujoco.mjtTrn.mjTRN_JOINT
    )
    motor.set_to_dcmotor([NO_MOTOR, NO_MOTOR], 1.0, **what)


def _wave(machine: Machine, name: str, sine: float, cosine: float, order: float) -> None:
    """A·sin(N·q) + B·cos(N·q) on the joint."""
    size = math.hypot(sine, cosine)
    if size > 0.0:
        _passive(machine, name, cogging=[size, order, math.atan2(cosine, sine)])


def _bias(machine: Machine, force: float) -> None:
    """A constant force of the drive."""
    drive = machine.spec.actuator(machine.drive)
    drive.biastype = mujoco.mjtBias.mjBIAS_AFFINE
    drive.biasprm[0] += force


def _coulomb(machine: Machine, one: Held, model: Corrected) -> None:
    """Friction loss, soft enough to turn round as the law does."""
    _ramp(machine, one.values["coulomb_torque"], one.values["softness"] * model.rest_speed)


def _ramp(machine: Machine, level: float, speed: float) -> None:
    """Level·tanh(speed over this one), by a friction constraint that is soft."""
    joint, width = machine.driven, RAMP * speed
    inertia = _moved_inertia(machine)
    step = machine.spec.option.timestep
    width = max(width, level * step / inertia)  # narrower, it would chatter
    joint.frictionloss += level
    # within the ramp the force is D·b·v with D = d/(1 - d)·M and b = damping/d
    weight = inertia / (1.0 - SOFT)
    joint.solimp_friction = [SOFT, SOFT, 1e-3, 0.5, 2.0]
    joint.solref_friction = [-1.0, -level / (width * weight)]


def _moved_inertia(machine: Machine) -> float:
    """Inertia of the driven joint as MuJoCo takes it for its constraints."""
    made = machine.spec.compile()
    dof = made.joint(machine.joint).dofadr[0]
    return float(1.0 / made.dof_invweight0[dof])


def _stribeck(machine: Machine, one: Held, model: Corrected) -> None:
    """By bristles; where they turn round at once the level is the constraint's, the peak theirs."""
    v = one.values
    level, excess = v["coulomb_torque"], v["breakaway_excess"]
    turn, speed = (v[n] * model.rest_speed for n in ("softness", "stribeck_ratio"))
    if v.get("presliding", 0.0) > turn * STEP:
        _bristles(machine, level, level + excess, speed, v["presliding"])
        return
    _ramp(machine, level, turn)
    _bristles(machine, 0.0, excess, speed, 0.1 * turn * STEP)


def _dahl(machine: Machine, one: Held, model: Corrected) -> None:
    level = one.values["sliding_torque"]
    damping = one.values.get("damping", 0.0)
    _bristles(machine, level, level, 1.0, one.values["presliding"], damping)


def _bristles(
    machine: Machine, low: float, high: float, speed: float, way: float, damping: float = 0.0
) -> None:
    """LuGre's bristles, which turn round within `way`; their damping over their stiffness [s]."""
    if high > 0.0:
        low, stiff = max(low, 1e-3 * high), high / way
        _passive(machine, "bristles", lugre=[stiff, damping * stiff, low, high, speed])


def _cogging(machine: Machine, one: Held, model: Corrected) -> None:
    v, base = one.values, one.values["order"] / model.angle
    waves = [("", 1.0), ("second_", v["ratio"]), ("third_", v["third_ratio"])]
    for k, (name, ratio) in enumerate(waves):
        _wave(machine, f"cogging_{k}", v[f"{name}sine"], v[f"{name}cosine"], ratio * base)


def _drag(machine: Machine, one: Held, model: Corrected) -> None:
    machine.driven.damping += np.array([0.0, one.values["drag"], 0.0])


def _hardening(machine: Machine, one: Held, model: Corrected) -> None:
    more = one.values["hardening"] * model.stiffness
    machine.driven.stiffness += np.array([0.0, 0.0, more])


def _rest(machine: Machine, one: Held, model: Corrected) -> None:
    _bias(machine, one.values["rest_angle"] * model.stiffness)


def _tilt(machine: Machine, one: Held, model: Corrected) -> None:
    option = machine.spec.option
    size = float(np.linalg.norm(option.gravity))
    turned = [math.sin(one.values["pitch"]), math.sin(one.values["roll"]), 0.0]
    option.gravity = option.gravity + size * np.array(turned)


def _lever(machine: Machine, one: Held, model: Corrected) -> None:
    _wave(machine, "weight", -one.values["sine"], -one.values["cosine"], 1.0)


def tip(machine: Machine, one: Held, model: Corrected) -> None:
    """The payload that was named."""
    _hang(machine, one.values["mass"], "payload", model)


def usual(machine: Machine, model: Corrected) -> None:
    """Payload and force that the logs have on the average, on a machine or at the tip of a body."""
    payload, numbers = model.usual["payload"], model.numbers
    if model.usual["offset"]:
        _bias(machine, -model.usual["offset"])
    if model.body is not None:
        if payload:
            _hang(machine, payload, "usual", model)
        return
    machine.driven.armature += payload * numbers["payload_inertia"]
    sine, cosine = (-payload * numbers[f"payload_{wave}"] for wave in ("sine", "cosine"))
    if model.axis == "rad":
        _wave(machine, "usual", sine, cosine, 1.0)
    elif cosine:
        _bias(machine, cosine)


def _hang(machine: Machine, mass: float, name: str, model: Corrected) -> None:
    """A point mass where the description says that a payload hangs."""
    assert model.body is not None
    spec = machine.spec
    site = next((s for s in spec.sites if s.name == model.body.tip), None)
    parent = site.parent if site else spec.body(model.body.tip)
    carried = parent.add_body(name=name, pos=site.pos if site else [0.0, 0.0, 0.0])
    weigh(carried, mass, 1e-9)


def _force(machine: Machine, one: Held, model: Corrected) -> None:
    _bias(machine, one.values["force"])


def _spring(machine: Machine, one: Held, model: Corrected) -> None:
    machine.driven.stiffness += np.array([one.values["stiffness"], 0.0, 0.0])
    _bias(machine, -one.values["bias"])


def _gain(machine: Machine, one: Held, model: Corrected) -> None:
    drive = machine.spec.actuator(machine.drive)
    drive.gainprm[0] /= 1.0 + one.values["gain_error"]


def _offset(machine: Machine, one: Held, model: Corrected) -> None:
    _bias(machine, -one.values["offset"] * machine.spec.actuator(machine.drive).gainprm[0])


def _shaft(machine: Machine, one: Held, model: Corrected) -> None:
    """A second joint that carries the load's share of the inertia, on a spring."""
    v, spec = one.values, machine.spec
    share, own = v["load_inertia"], 2.0 * math.pi * v["frequency"]
    motor = spec.body("load")
    turns = model.axis == "rad"
    for body, inertia in ((motor, model.numbers["inertia"] - share), (None, share)):
        body = body or spec.worldbody.add_body(name="behind")
        weigh(body, *((1.0, inertia) if turns else (inertia, 1.0)))
    kind = machine.driven.type
    spec.body("behind").add_joint(name="behind", type=kind, axis=machine.driven.axis)
    tendon = spec.add_tendon(name="shaft")
    tendon.wrap_joint(machine.joint, 1.0)
    tendon.wrap_joint("behind", -1.0)
    tendon.stiffness = [share * own**2, 0.0, 0.0]
    tendon.damping = [2.0 * v["damping"] * own * share, 0.0, 0.0]
    tendon.springlength = [0.0, 0.0]
    spec.option.timestep = min(spec.option.timestep, SWING)


def _maxwell(machine: Machine, one: Held, model: Corrected) -> None:
    """A spring whose other end creeps in a damper: a further joint of next to no inertia."""
    v, spec, joint = one.values, machine.spec, machine.driven
    stiffness = v["share"] * model.stiffness
    body = spec.worldbody.add_body(name="relaxed")
    weigh(body, 1e-3, LIGHT)
    creeping = body.add_joint(name="relaxed", type=joint.type, axis=joint.axis)
    creeping.damping = [stiffness * v["time"], 0.0, 0.0]
    tendon = spec.add_tendon(name="relaxing")
    tendon.wrap_joint(machine.joint, 1.0)
    tendon.wrap_joint("relaxed", -1.0)
    tendon.stiffness, tendon.springlength = [stiffness, 0.0, 0.0], [0.0, 0.0]


def _lag(machine: Machine, one: Held, model: Corrected) -> None:
    """A first-order filter of the reading."""
    reading, _ = _readings(machine)
    reading.dyntype, reading.dynprm[0] = mujoco.mjtDyn.mjDYN_FILTEREXACT, one.values["time"]
    reading.actearly = True


def _late(machine: Machine, one: Held, model: Corrected) -> None:
    """Sensors that tell what was some time ago."""
    for sensor in _readings(machine)[1]:
        sensor.delay, sensor.interp = one.values["latency"], 1
        sensor.nsample = math.ceil(one.values["latency"] / SWING) + 2


def _readings(machine: Machine) -> tuple[mujoco._specs.MjsActuator, list[mujoco._specs.MjsSensor]]:
    """An actuator that moves nothing, whose control is the drive's, and sensors of it and the axis.

    Sensors `effort` and `position` then are what the log shows.
    """
    spec = machine.spec
    if found := spec.actuator(READING):
        return found, [spec.sensor("effort"), spec.sensor("position")]
    spec.worldbody.add_site(name="log")
    reading = spec.add_actuator(name=READING, target="log", trntype=mujoco.mjtTrn.mjTRN_SITE)
    effort = spec.add_sensor(
        name="effort",
        type=mujoco.mjtSensor.mjSENS_ACTUATORFRC,
        objtype=mujoco.mjtObj.mjOBJ_ACTUATOR,
        objname=READING,
    )
    position = spec.add_sensor(
        name="position",
        type=mujoco.mjtSensor.mjSENS_JOINTPOS,
        objtype=mujoco.mjtObj.mjOBJ_JOINT,
        objname=machine.joint,
    )
    return reading, [effort, position]


ON_DRIVE = {"tendon.force", "sensing.current", "body.tip_mass"}  # whatever the drive pulls on
HOLDERS: dict[tuple[str, str], Holder] = {
    ("coulomb_friction", "motor.torque"): _coulomb,
    ("stribeck_friction", "motor.torque"): _stribeck,
    ("presliding_friction", "motor.torque"): _dahl,
    ("cogging", "motor.torque"): _cogging,
    ("quadratic_drag", "motor.torque"): _drag,
    ("stiffness_hardening", "body.hinge_torque"): _hardening,
    ("rest_curvature", "body.hinge_torque"): _rest,
    ("mount_tilt", "body.hinge_torque"): _tilt,
    ("tip_payload", "body.hinge_torque"): _lever,
    ("tip_payload", "body.tip_mass"): tip,
    ("joint_viscoelasticity", "body.hinge_torque"): _maxwell,
    ("constant_force", "tendon.force"): _force,
    ("parallel_spring", "tendon.force"): _spring,
    ("current_gain", "sensing.current"): _gain,
    ("current_offset", "sensing.current"): _offset,
    ("current_lag", "sensing.report"): _lag,
    ("feedback_latency", "sensing.frame"): _late,
    ("gear_compliance", "motor.torque"): _shaft,
}


def holder(one: Held, model: Corrected) -> Holder | None:
    """What puts an effect into a model; None where MuJoCo cannot hold it by itself."""
    if "load_inertia" in one.values:  # a second joint takes its share of an axis without a body
        share = one.values["load_inertia"] / (model.numbers["inertia"] or 1.0)
        if model.body is not None or not 0.0 < share < 1.0:
            return None
    if model.body is not None and model.body.tendon and one.law.port not in ON_DRIVE:
        return None
    return HOLDERS.get((one.name, one.law.port))
