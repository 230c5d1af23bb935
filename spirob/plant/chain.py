"""The arm as a planar chain: its step while nothing is touched, and the outline that touches.

Between touches MuJoCo's `implicitfast` solves, of a chain of hinges,

    (M + h D) q̈ = τ - k q - D q̇ - C(q, q̇),        q̇ += h q̈,  q += h q̇

and so does this at a fifth of the price, in three numbers a body instead of six and without asking
what might collide.  It takes the body's numbers from the MuJoCo model and agrees with it to
rounding (tests/plant/test_chain.py); `is_free` says when it may, and MuJoCo plays everything else:
end stops, objects, and an arm whose turns lie near each other.

Forces and motions are taken about the world's origin: hinge i at (x, y) moves what hangs on it by
s_i = (1, y, -x), and the inertia of a body of mass m at c is

    [[I_c + m|c|², -m c_y, m c_x], [-m c_y, m, 0], [m c_x, 0, m]].

With I the inertia of all that hangs on hinge i, its own hinges free to give,

    U_i = I s_i        d_i = s_i·U_i + I_a + h D_i        I_parent += I - U_i U_iᵀ/d_i

(Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 7), which solves in 2N steps.

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
from spirob.plant.tendon import small_angle
from spirob.robot import MOTORS

SKIPPED = 2  # neighbours on either side that the end stops keep from meeting
ROWS = (
    "length",  # from each hinge to the next [m]
    "mass",  # [kg]
    "centre",  # of mass, from the hinge along the unit [m]
    "inertia",  # about the centre of mass [kg·m²]
    "armature",  # [kg·m²]
    "stiffness",  # [N·m/rad]
    "damping",  # [N·m·s/rad]
    "limit",  # [rad]
    "middle",  # of the circle round its outline, along the unit [m]
    "radius",  # of that circle [m]
)


def chain_of(model: mujoco.MjModel, hinges: int, lines: np.ndarray, bows: np.ndarray) -> np.ndarray:
    """The numbers of each unit, (len(ROWS), N), from the model's first `hinges` bodies.

    lines  (N, 6) numbers of the geoms of each unit's outline, an edge first;  bows  (N,) how far a
    bend carries them out [m/rad].  Bodies that are fixed to the last unit are part of it.
    """
    units = slice(1, hinges + 1)
    rows = np.zeros((hinges, len(ROWS)))
    rows[:-1, 0] = model.body_pos[2 : hinges + 1, 0]
    rows[:, 1] = model.body_mass[units]
    rows[:, 2] = model.body_ipos[units, 0]
    rows[:, 3] = model.body_inertia[units, 2]
    rows[:, 4] = model.dof_armature[:hinges]
    rows[:, 5] = model.jnt_stiffness.reshape(model.njnt, -1)[:hinges, 0]
    rows[:, 6] = model.dof_damping.reshape(model.nv, -1)[:hinges, 0]
    rows[:, 7] = model.jnt_range[:hinges, 1]
    for body in range(hinges + 1, model.nbody):
        if model.body_weldid[body] == hinges:
            _weld(rows[-1], model, body)
    edge = lines[:, 0]
    rows[:, 8] = model.geom_pos[edge, 0]
    radius, half = model.geom_size[edge, 0], model.geom_size[edge, 1]
    corner = np.hypot(half + radius, np.abs(model.geom_pos[edge, 1]) + radius)
    rows[:, 9] = np.maximum(corner, rows[:, 8]) + bows * rows[:, 7]  # faces end on the hinges
    return np.ascontiguousarray(rows.T)


def _weld(row: np.ndarray, model: mujoco.MjModel, body: int) -> None:
    """Add a body that is fixed to the last unit, on its axis."""
    mass, centre, inertia = row[1:4]
    more = model.body_mass[body]
    where = model.body_pos[body, 0] + model.body_ipos[body, 0]
    middle = (mass * centre + more * where) / (mass + more)
    row[3] = inertia + mass * (centre - middle) ** 2 + model.body_inertia[body, 2]
    row[3] += more * (where - middle) ** 2
    row[1:3] = mass + more, middle


def is_free(qpos, chain, post, place):
    """Whether no end stop is reached, and no unit is near another's or the post's circle.

    post   x, y, radius of a fixed cylinder [m]; none where that is 0
    place  (8, N) filled with each hinge's x, y, the unit's direction, its circle's middle,
           and sine and cosine of each hinge's angle
    """
    hinges = chain.shape[1]
    beyond = 0
    for i in range(hinges):
        beyond += abs(qpos[i]) >= chain[7, i]
        place[6, i], place[7, i] = small_angle(qpos[i])
    if beyond > 0:
        return False
    c, s, x, y = 1.0, 0.0, 0.0, 0.0
    for i in range(hinges):
        c, s = c * place[7, i] - s * place[6, i], s * place[7, i] + c * place[6, i]
        place[0, i], place[1, i], place[2, i], place[3, i] = x, y, c, s
        place[4, i], place[5, i] = x + chain[8, i] * c, y + chain[8, i] * s
        x += chain[0, i] * c
        y += chain[0, i] * s
    if post[2] > 0.0:
        for i in range(hinges):
            dx, dy = place[4, i] - post[0], place[5, i] - post[1]
            reach = chain[9, i] + post[2]
            if dx * dx + dy * dy <= reach * reach:
                return False
    meeting = 0  # counted, not left at the first, so that the compiler takes four at a time
    for i in range(hinges - SKIPPED - 1):
        for j in range(i + SKIPPED + 1, hinges):
            dx, dy = place[4, i] - place[4, j], place[5, i] - place[5, j]
            reach = chain[9, i] + chain[9, j]
            meeting += dx * dx + dy * dy <= reach * reach
    return meeting == 0


def chain_factor(chain, place, damping_step, factor):
    """Factor M + h D: U in the first three rows of factor (4, N), 1/d in the last.

    damping_step  h [s]; 0 for M alone
    """
    zz, zx, zy, xx, xy, yy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(chain.shape[1]):
        i = chain.shape[1] - 1 - k
        mass = chain[1, i]
        x, y = place[0, i], place[1, i]
        cx, cy = x + chain[2, i] * place[2, i], y + chain[2, i] * place[3, i]
        zz += chain[3, i] + mass * (cx * cx + cy * cy)
        zx -= mass * cy
        zy += mass * cx
        xx += mass
        yy += mass
        uz, ux, uy = zz + zx * y - zy * x, zx + xx * y - xy * x, zy + xy * y - yy * x
        inverse = 1.0 / (uz + y * ux - x * uy + chain[4, i] + damping_step * chain[6, i])
        factor[0, i], factor[1, i], factor[2, i], factor[3, i] = uz, ux, uy, inverse
        zz -= uz * uz * inverse
        zx -= uz * ux * inverse
        zy -= uz * uy * inverse
        xx -= ux * ux * inverse
        xy -= ux * uy * inverse
        yy -= uy * uy * inverse


def chain_solve(place, factor, right, found):
    """Solve with what `chain_factor` left: right, found (N,) [N·m], [rad/s²]."""
    hinges = factor.shape[1]
    pz, px, py = 0.0, 0.0, 0.0
    for k in range(hinges):
        i = hinges - 1 - k
        left = right[i] - pz - place[1, i] * px + place[0, i] * py
        found[i] = left
        share = left * factor[3, i]
        pz += factor[0, i] * share
        px += factor[1, i] * share
        py += factor[2, i] * share
    az, ax, ay = 0.0, 0.0, 0.0
    for i in range(hinges):
        moved = factor[0, i] * az + factor[1, i] * ax + factor[2, i] * ay
        found[i] = (found[i] - moved) * factor[3, i]
        az += found[i]
        ax += found[i] * place[1, i]
        ay -= found[i] * place[0, i]


def chain_step(qpos, qvel, applied, chain, place, gravity, step, factor, work):
    """One step from the present pose under `applied` [N·m]; work (2, N) is scratch."""
    hinges = chain.shape[1]
    force, found = work[0], work[1]
    # accelerations of the centres while all hinges turn evenly, times the mass
    rate, ax, ay = 0.0, -gravity[0], -gravity[1]
    for i in range(hinges):
        rate += qvel[i]
        square = rate * rate
        pull = square * chain[2, i]
        found[i] = ax - pull * place[2, i]
        force[i] = ay - pull * place[3, i]
        ax -= square * chain[0, i] * place[2, i]
        ay -= square * chain[0, i] * place[3, i]
    moment, fx, fy = 0.0, 0.0, 0.0
    for k in range(hinges):
        i = hinges - 1 - k
        c, s = place[2, i], place[3, i]
        own_x, own_y = chain[1, i] * found[i], chain[1, i] * force[i]
        moment += chain[0, i] * (c * fy - s * fx) + chain[2, i] * (c * own_y - s * own_x)
        fx += own_x
        fy += own_y
        force[i] = applied[i] - chain[5, i] * qpos[i] - chain[6, i] * qvel[i] - moment
    chain_factor(chain, place, step, factor)
    chain_solve(place, factor, force, found)
    for i in range(hinges):
        qvel[i] += step * found[i]
        qpos[i] += step * qvel[i]


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
