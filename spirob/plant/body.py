"""The arm as a MuJoCo chain of hinges, from the spiral's law, its weight, and what it may touch.

Each unit is a trapezoid mirrored about the elastic axis, of thickness h·width; its two outer edges
and its four slanted faces are thin capsules, for objects and for other turns of the arm.
Neighbouring faces never meet: the joints' end stop is at 0.96·Δθ.  The
tendons are not MuJoCo's: their lengths are known in closed form (`plant.tendon`), which halves the
cost of a step.  `tendons=True` adds them for export, so that other tools see the same machine.

The arm's weight acts at each of its hinges.  For a chain of units with mass m_i and length l_i,
direction u_i and centre of mass at l_i/2, the first moment of all that hinge i carries is

    S_i = (m_i/2 + M_(i+1)) l_i u_i + S_(i+1),      M_i = m_i + M_(i+1),

with the mass at the tip as M_(N+1).  Gravity g then turns the hinge by the moment S_i × g.

Ball and peg are bodies of their own beside the arm, so MuJoCo moves them and the coupled loop does
not know of them; their coordinates come after the hinges.  The ball slides in the plane.  The peg
sits on a wheel so heavy that no contact slows it.  Gravity in the plane acts on neither.
"""

import copy
import math
from functools import lru_cache

import mujoco
import numpy as np

from spirob.geometry import SpiralArm
from spirob.plant.rig import Arm, Holes
from spirob.plant.tendon import with_holes
from spirob.robot import MOTORS, Ball, Cylinder, Peg, Scene
from spirob.unit_table import Geometry

CONTACT = [0.001, 1.0]  # s, damping ratio: as stiff as MuJoCo has it, two steps; a print is stiffer
ARM_BIT, OBJECT_BIT = 1, 2  # arm touches arm and objects; objects touch the arm
WHEEL = 1e3  # kg·m², of the peg's wheel: a newton at 10 mm slows it by 1e-5 rad/s in a second
OUTLINE_RADIUS = 0.1  # capsule radius over half width
Shape = tuple[Geometry, int]  # what the arm is, and into how many units the model cuts it
SPRINGY = {  # the arm's numbers from which nothing but its hinges' stiffness and damping follows
    name: getattr(Arm(), name)
    for name in (
        "base_stiffness",
        "stiffness_exponent",
        "stiffness_bow",
        "damping_time",
        "bends_per_hinge",
    )
}


def add_objects(spec: mujoco.MjSpec, scene: Scene, geometry: SpiralArm) -> None:
    """Add what the scene holds; call it when the arm is complete."""
    height = 2 * geometry.half_width[0]  # taller than the arm is thick
    if scene.cylinder is not None:
        _add_cylinder(spec, scene.cylinder, height)
    if scene.ball is not None:
        _add_ball(spec, scene.ball)
    if scene.peg is not None:
        _add_peg(spec, scene.peg, height)


def launch(data: mujoco.MjData, scene: Scene, hinges: int) -> None:
    """Give ball or peg its velocity at the start of a trial."""
    if scene.ball is not None:
        data.qvel[hinges:] = scene.ball.vx, scene.ball.vy
    if scene.peg is not None:
        data.qvel[hinges:] = 2 * np.pi / scene.peg.period


def _add_cylinder(spec: mujoco.MjSpec, cylinder: Cylinder, half: float) -> None:
    _round(
        spec.worldbody,
        "cylinder",
        cylinder.diameter,
        cylinder.friction,
        [cylinder.x, cylinder.y, -half, cylinder.x, cylinder.y, half],
    )


def _add_ball(spec: mujoco.MjSpec, ball: Ball) -> None:
    body = spec.worldbody.add_body(name="ball", pos=[ball.x, ball.y, 0], gravcomp=1.0)
    body.explicitinertial = True
    body.mass = ball.mass
    body.inertia = np.full(3, ball.mass * ball.diameter**2 / 10)
    for axis in ([1, 0, 0], [0, 1, 0]):
        body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
    _round(body, "ball", ball.diameter, ball.friction, None)


def _add_peg(spec: mujoco.MjSpec, peg: Peg, half: float) -> None:
    body = spec.worldbody.add_body(name="peg", pos=[peg.x, peg.y, 0], gravcomp=1.0)
    body.explicitinertial = True
    body.mass = 1.0
    body.inertia = np.full(3, WHEEL)
    body.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
    x, y = peg.radius * np.cos(peg.phase), peg.radius * np.sin(peg.phase)
    _round(body, "peg", peg.diameter, peg.friction, [x, y, -half, x, y, half])


def _round(body, name: str, diameter: float, friction: float, ends: list[float] | None) -> None:
    """A capsule between two ends [m], or a sphere at the body's origin."""
    kind = mujoco.mjtGeom.mjGEOM_SPHERE if ends is None else mujoco.mjtGeom.mjGEOM_CAPSULE
    shape = {} if ends is None else {"fromto": ends}
    body.add_geom(
        name=name,
        type=kind,
        size=[diameter / 2, 0, 0],
        contype=OBJECT_BIT,
        conaffinity=ARM_BIT,
        friction=[friction, 0.005, 0.0001],
        solref=CONTACT,
        **shape,
    )


def hinge_stiffness(arm: Arm, geometry: SpiralArm) -> np.ndarray:
    """k_i = k_1 s_i^e exp(4c u_i(1 - u_i)) [N·m/rad], (N,), with u_i from 0 to 1 along the arm."""
    along = np.linspace(0.0, 1.0, geometry.units)
    profile = np.exp(4.0 * arm.stiffness_bow * along * (1.0 - along))
    return arm.base_stiffness * geometry.scale**arm.stiffness_exponent * profile


def unit_inertia(arm: Arm, geometry: SpiralArm) -> tuple[np.ndarray, np.ndarray]:
    """Mass [kg] and moment about the centre of mass, axis z [kg·m²], of each unit, (N,).

    Trapezoid with parallel sides L ∓ ... along x: at height y the unit's length is
    L - 2|y| tan(Δθ/2), integrated over |y| ≤ w.
    """
    w, length = geometry.half_width, geometry.unit_length
    slope = np.tan(geometry.unit_angle / 2)
    thickness = arm.thickness_ratio * 2 * w
    area = 2 * (length * w - slope * w**2)
    # ∫ y² ℓ(y) dy and ∫ ℓ(y)³/12 dy over both halves
    along_y = 2 * (length * w**3 / 3 - slope * w**4 / 2)
    short = length - 2 * w * slope
    along_x = (length**4 - short**4) / (48 * slope)
    surface = arm.density * thickness
    return surface * area, surface * (along_x + along_y)


def build_spec(
    arm: Arm,
    scene: Scene,
    geometry: SpiralArm,
    timestep: float,
    tendons: bool = False,
    tip_mass: float = 0.0,
    holes: Holes | None = None,
) -> mujoco.MjSpec:
    """The arm, straight along +x from the origin, in its scene, with a point mass at its tip.

    holes  where the tendons run, with `tendons`; None: as drawn

    Masses in kg, lengths in m, angles in rad; gravity from `arm.gravity_x`, `arm.gravity_y`.
    """
    run = with_holes(geometry, holes or Holes())
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    _set_options(spec, arm, timestep)
    mass, inertia = unit_inertia(arm, geometry)
    stiffness = hinge_stiffness(arm, geometry)
    parent = spec.worldbody
    for i in range(geometry.units):
        offset = 0.0 if i == 0 else geometry.unit_length[i - 1]
        if tendons:
            _add_guides(parent, run.guide_before[i] + [offset, 0], f"before_{i}")
        parent = parent.add_body(name=f"unit_{i}", pos=[offset, 0, 0])
        _add_hinge(parent, i, arm, geometry, stiffness[i])
        parent.explicitinertial = True
        parent.mass = mass[i]
        parent.ipos = [geometry.unit_length[i] / 2, 0, 0]
        parent.inertia = np.full(3, inertia[i])
        _add_outline(parent, i, arm, geometry)
        if tendons:
            _add_guides(parent, run.guide_after[i], f"after_{i}")
    if tip_mass > 0.0:
        _add_tip(parent, geometry.unit_length[-1], tip_mass)
    add_objects(spec, scene, geometry)
    if tendons:
        _add_tendons(spec, geometry.units)
    return spec


def _set_options(spec: mujoco.MjSpec, arm: Arm, timestep: float) -> None:
    spec.option.timestep = timestep
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.gravity = [arm.gravity_x, arm.gravity_y, 0.0]


def _add_hinge(body, i: int, arm: Arm, geometry: SpiralArm, stiffness: float) -> None:
    limit = arm.limit_ratio * geometry.hinge_angle[i]
    joint = body.add_joint(
        name=f"hinge_{i}",
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=[0, 0, 1],
        limited=mujoco.mjtLimited.mjLIMITED_TRUE,
        range=[-limit, limit],
        armature=arm.armature * geometry.scale[i] ** 2,
        solref_limit=[0.004, 1.0],
        # the default gives way by 10° at 70 N, past the angle where the guides meet
        solimp_limit=[0.99, 0.9999, 0.01, 0.5, 2.0],
    )
    joint.stiffness = np.array([stiffness, 0.0, 0.0])
    joint.damping = np.array([arm.damping_time * stiffness, 0.0, 0.0])


def _add_outline(body, i: int, arm: Arm, geometry: SpiralArm) -> None:
    """Both edges and the four slanted faces; without these a tip enters the base from behind."""
    w, length = geometry.half_width[i], geometry.unit_length[i]
    slope, radius = np.tan(geometry.unit_angle[i] / 2), OUTLINE_RADIUS * w
    height = w - radius
    inset = height * slope + radius
    far = max(length - inset, inset + 1e-4)
    lower = height - radius  # where a face ends, so that the corner is the edge's alone
    near_end, far_end = inset - radius * slope, far + radius * slope
    for name, side in zip(MOTORS, (1, -1), strict=True):
        y, end = side * height, side * lower
        edge = _line(body, f"{name}_edge_{i}", radius, (inset, y), (far, y), arm)
        edge.contype = ARM_BIT  # faces meet edges and objects, not each other
        _line(body, f"{name}_near_face_{i}", radius, (radius, 0), (near_end, end), arm)
        _line(body, f"{name}_far_face_{i}", radius, (length - radius, 0), (far_end, end), arm)


def _line(body, name: str, radius: float, start, end, arm: Arm):
    return body.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_CAPSULE,
        size=[radius, 0, 0],
        fromto=[*start, 0, *end, 0],
        contype=0,
        conaffinity=ARM_BIT | OBJECT_BIT,
        friction=[arm.contact_friction, 0.005, 0.0001],
        solref=CONTACT,
        mass=0.0,
    )


def _add_tip(parent, length: float, mass: float) -> None:
    tip = parent.add_body(name="tip", pos=[length, 0, 0])
    tip.explicitinertial = True
    tip.mass = mass
    tip.ipos = [0, 0, 0]  # left out, it would be the offset once more
    tip.inertia = np.full(3, mass * length**2 * 1e-2)  # small: a point, but never singular


def _add_guides(body, position: np.ndarray, name: str) -> None:
    for motor, side in zip(MOTORS, (1, -1), strict=True):
        body.add_site(name=f"{motor}_{name}", pos=[position[0], side * position[1], 0])


def _add_tendons(spec: mujoco.MjSpec, units: int) -> None:
    for motor in MOTORS:
        tendon = spec.add_tendon(name=motor)
        for i in range(units):
            tendon.wrap_site(f"{motor}_before_{i}")
            tendon.wrap_site(f"{motor}_after_{i}")
        spec.add_actuator(
            name=motor,
            target=motor,
            trntype=mujoco.mjtTrn.mjTRN_TENDON,
            gear=[-1, 0, 0, 0, 0, 0],  # positive control pulls
        )


@lru_cache(maxsize=512)
def compiled(
    arm: Arm, scene: Scene, shape: Shape, timestep: float, tip_mass: float, scatter: bytes
) -> mujoco.MjModel:
    """The arm in its scene, ready to be played.

    scatter  by how much each hinge's stiffness and damping are multiplied, as bytes; none if empty

    Only its springs differ from fit to fit, and a copy that gets others is, bit by bit, what takes
    a hundred times as long to compile.
    """
    plain = Arm(**{name: SPRINGY.get(name, getattr(arm, name)) for name in Arm.parameters()})
    model = copy.copy(_body(plain, scene, shape, timestep, tip_mass))
    units = shape[1]
    stiffness = hinge_stiffness(arm, shape[0].arm(units))
    factors = np.frombuffer(scatter) if scatter else np.ones(units)
    model.jnt_stiffness.reshape(model.njnt, -1)[:units, 0] = factors * stiffness
    model.dof_damping.reshape(model.nv, -1)[:units, 0] = factors * (arm.damping_time * stiffness)
    return model


@lru_cache(maxsize=64)
def _body(arm: Arm, scene: Scene, shape: Shape, timestep: float, tip_mass: float) -> mujoco.MjModel:
    model = build_spec(arm, scene, shape[0].arm(shape[1]), timestep, tip_mass=tip_mass).compile()
    # a reset in mid-run would hide that the model diverged
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    return model


def hinge_weights(angles, units, weight):
    """Fill weight (N, 2) [N·m]: torque at each hinge if gravity pointed along +x, along +y.

    angles (N,) of the hinges [rad];  units (N + 1, 2) mass [kg] and length [m], the tip's mass last
    """
    hinges = weight.shape[0]
    direction = 0.0
    for i in range(hinges):
        direction += angles[i]
    beyond = units[hinges, 0]
    moment_x = 0.0
    moment_y = 0.0
    for i in range(hinges - 1, -1, -1):
        lever = (0.5 * units[i, 0] + beyond) * units[i, 1]
        moment_x += lever * math.cos(direction)
        moment_y += lever * math.sin(direction)
        weight[i, 0] = -9.80665 * moment_y  # standard gravity [m/s²]
        weight[i, 1] = 9.80665 * moment_x
        beyond += units[i, 0]
        direction -= angles[i]
