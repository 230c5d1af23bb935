"""What the arm may touch, and the outline of a unit that bends over its length.

Ball and peg are bodies of their own beside the arm, so MuJoCo moves them and the coupled loop does
not know of them; their coordinates come after the hinges.  The ball slides in the plane.  The peg
sits on a wheel so heavy that no contact slows it.  Gravity in the plane acts on neither.

A rigid unit touches an object with the middle of its edge.  In an arm that bends evenly, n times
between two hinges of the chain, each by q/n, that middle lies beyond the chord and the chord is
shorter than the unit.  Wound evenly by q a unit, the elastic axis passes the middle of an edge at

    r_n = L/(2n tan(q/2n))        from the centre of the turn,

to first order in q farther out than that of the rigid unit by

    r_n - r_1 = L q/12·(1 - 1/n²):

with n = 2 a sixteenth of L q.  So the outline is carried outwards by this much in each step, for as
long as there is something to touch.  The moment that a contact does along with this small motion is
left out: with n = 2, on each of the two hinges a sixteenth of what it does on the nearer one.
"""

import mujoco
import numpy as np

from spirob.geometry import SpiralArm
from spirob.robot import MOTORS, Ball, Cylinder, Peg, Scene

CONTACT = [0.001, 1.0]  # s, damping ratio: as stiff as MuJoCo has it, two steps; a print is stiffer
ARM_BIT, OBJECT_BIT = 1, 2  # arm touches arm and objects; objects touch the arm
WHEEL = 1e3  # kg·m², of the peg's wheel: a newton at 10 mm slows it by 1e-5 rad/s in a second


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


LINES = ("edge", "near_face", "far_face")  # of either side of a unit; near the base, far from it


def bow(geometry: SpiralArm, bends: float) -> np.ndarray:
    """How far the middle of each unit moves out per angle of its bend, (N,) [m/rad]."""
    return geometry.unit_length / 12.0 * (1.0 - 1.0 / bends**2)


def outlines(model: mujoco.MjModel, hinges: int) -> np.ndarray:
    """Numbers of the geoms of each unit's outline, (N, 6): edge and two faces of either side."""
    lines = [f"{motor}_{line}" for motor in MOTORS for line in LINES]
    names = [[f"{line}_{i}" for line in lines] for i in range(hinges)]
    return np.array([[model.geom(name).id for name in row] for row in names])


def bend_outline(qpos, bows, heights, numbers, positions):
    """Carry each unit's outline to where its bend, the mean of its two hinges, puts it.

    heights (N, 6) where its lines are in the straight arm [m];  positions (geoms, 3) MuJoCo's own
    """
    hinges = bows.shape[0]
    for i in range(hinges):
        bend = qpos[i] if i + 1 == hinges else 0.5 * (qpos[i] + qpos[i + 1])
        for line in range(numbers.shape[1]):
            positions[numbers[i, line], 1] = heights[i, line] - bows[i] * bend
