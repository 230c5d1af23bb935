"""The arm that touches nothing, as a planar chain: MuJoCo's own step, a fifth of its price.

Between touches MuJoCo's `implicitfast` solves, of a chain of hinges,

    (M + h D) q̈ = τ - k q - D q̇ - C(q, q̇),        q̇ += h q̈,  q += h q̇

and so does this, in three numbers a body instead of six and without asking what might collide.  It
takes the body's numbers from the MuJoCo model and agrees with it to rounding
(tests/plant/test_chain.py); `is_free` says when it may, and MuJoCo plays everything else: end
stops, objects, and an arm whose turns lie near each other.

Forces and motions are taken about the world's origin: hinge i at (x, y) moves what hangs on it by
s_i = (1, y, -x), and the inertia of a body of mass m at c is

    [[I_c + m|c|², -m c_y, m c_x], [-m c_y, m, 0], [m c_x, 0, m]].

With I the inertia of all that hangs on hinge i, its own hinges free to give,

    U_i = I s_i        d_i = s_i·U_i + I_a + h D_i        I_parent += I - U_i U_iᵀ/d_i

(Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 7), which solves in 2N steps.
"""

import math

import mujoco
import numpy as np

SKIPPED = 2  # neighbours on either side that the end stops keep from meeting
COLUMNS = (
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


def chain_of(model: mujoco.MjModel, hinges: int, edges: np.ndarray, bows: np.ndarray) -> np.ndarray:
    """The numbers of each unit, (N, len(COLUMNS)), from the model's first `hinges` bodies.

    edges  (N, 2) numbers of the two geoms that are a unit's outline;  bows  (N,) how far a bend
    carries them out [m/rad].  Bodies that are fixed to the last unit are part of it.
    """
    units = slice(1, hinges + 1)
    rows = np.zeros((hinges, len(COLUMNS)))
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
    outline = edges[:, 0]
    rows[:, 8] = model.geom_pos[outline, 0]
    radius, half = model.geom_size[outline, 0], model.geom_size[outline, 1]
    rows[:, 9] = np.hypot(half + radius, np.abs(model.geom_pos[outline, 1]) + radius)
    rows[:, 9] += bows * rows[:, 7]
    return rows


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
    place  (N, 6) filled with each hinge's x, y, the unit's direction, and its circle's middle
    """
    hinges = chain.shape[0]
    angle, x, y = 0.0, 0.0, 0.0
    for i in range(hinges):
        if abs(qpos[i]) >= chain[i, 7]:
            return False
        angle += qpos[i]
        c, s = math.cos(angle), math.sin(angle)
        place[i, 0], place[i, 1], place[i, 2], place[i, 3] = x, y, c, s
        place[i, 4], place[i, 5] = x + chain[i, 8] * c, y + chain[i, 8] * s
        x += chain[i, 0] * c
        y += chain[i, 0] * s
    if post[2] > 0.0:
        for i in range(hinges):
            dx, dy = place[i, 4] - post[0], place[i, 5] - post[1]
            reach = chain[i, 9] + post[2]
            if dx * dx + dy * dy <= reach * reach:
                return False
    for i in range(hinges):
        for j in range(i + SKIPPED + 1, hinges):
            dx, dy = place[i, 4] - place[j, 4], place[i, 5] - place[j, 5]
            reach = chain[i, 9] + chain[j, 9]
            if dx * dx + dy * dy <= reach * reach:
                return False
    return True


def chain_factor(chain, place, damping_step, factor):
    """Factor M + h D: U in the first three columns of factor (N, 4), 1/d in the last.

    damping_step  h [s]; 0 for M alone
    """
    zz, zx, zy, xx, xy, yy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(chain.shape[0]):
        i = chain.shape[0] - 1 - k
        mass = chain[i, 1]
        x, y = place[i, 0], place[i, 1]
        cx, cy = x + chain[i, 2] * place[i, 2], y + chain[i, 2] * place[i, 3]
        zz += chain[i, 3] + mass * (cx * cx + cy * cy)
        zx -= mass * cy
        zy += mass * cx
        xx += mass
        yy += mass
        uz, ux, uy = zz + zx * y - zy * x, zx + xx * y - xy * x, zy + xy * y - yy * x
        inverse = 1.0 / (uz + y * ux - x * uy + chain[i, 4] + damping_step * chain[i, 6])
        factor[i, 0], factor[i, 1], factor[i, 2], factor[i, 3] = uz, ux, uy, inverse
        zz -= uz * uz * inverse
        zx -= uz * ux * inverse
        zy -= uz * uy * inverse
        xx -= ux * ux * inverse
        xy -= ux * uy * inverse
        yy -= uy * uy * inverse


def chain_solve(place, factor, right, found):
    """Solve with what `chain_factor` left: right, found (N,) [N·m], [rad/s²]."""
    hinges = factor.shape[0]
    pz, px, py = 0.0, 0.0, 0.0
    for k in range(hinges):
        i = hinges - 1 - k
        left = right[i] - pz - place[i, 1] * px + place[i, 0] * py
        found[i] = left
        share = left * factor[i, 3]
        pz += factor[i, 0] * share
        px += factor[i, 1] * share
        py += factor[i, 2] * share
    az, ax, ay = 0.0, 0.0, 0.0
    for i in range(hinges):
        moved = factor[i, 0] * az + factor[i, 1] * ax + factor[i, 2] * ay
        found[i] = (found[i] - moved) * factor[i, 3]
        az += found[i]
        ax += found[i] * place[i, 1]
        ay -= found[i] * place[i, 0]


def chain_step(qpos, qvel, applied, chain, place, gravity, step, factor, work):
    """One step from the present pose under `applied` [N·m]; work (2, N) is scratch."""
    hinges = chain.shape[0]
    force, found = work[0], work[1]
    # accelerations of the centres while all hinges turn evenly, times the mass
    rate, ax, ay = 0.0, -gravity[0], -gravity[1]
    for i in range(hinges):
        rate += qvel[i]
        square = rate * rate
        pull = square * chain[i, 2]
        found[i] = ax - pull * place[i, 2]
        force[i] = ay - pull * place[i, 3]
        ax -= square * chain[i, 0] * place[i, 2]
        ay -= square * chain[i, 0] * place[i, 3]
    moment, fx, fy = 0.0, 0.0, 0.0
    for k in range(hinges):
        i = hinges - 1 - k
        c, s = place[i, 2], place[i, 3]
        own_x, own_y = chain[i, 1] * found[i], chain[i, 1] * force[i]
        moment += chain[i, 0] * (c * fy - s * fx) + chain[i, 2] * (c * own_y - s * own_x)
        fx += own_x
        fy += own_y
        force[i] = applied[i] - chain[i, 5] * qpos[i] - chain[i, 6] * qvel[i] - moment
    chain_factor(chain, place, step, factor)
    chain_solve(place, factor, force, found)
    for i in range(hinges):
        qvel[i] += step * found[i]
        qpos[i] += step * qvel[i]
