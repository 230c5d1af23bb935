"""A joint of a planar arm with gravity, while the arm's other joint moves and disturbs it.

Lagrange's equations of two links, by hand; the angle of the second counts from the first:

    M(q)·q'' + c(q, q') + g(q) = τ - b·q' - friction

Time stepping after Moreau: speeds change by impulses, those of dry friction lie between its levels
and stop a joint exactly where they can.  Friction that turns round over a way is a spring that
slips at its level.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from spirob.campaign.simulators.hidden import Hidden, drive, level, memory, passive, remember
from spirob.campaign.simulators.motion import (
    DRIVEN,
    FINE,
    Machine,
    Motion,
    Plan,
    Simulator,
    drawn_effort,
    log_uniform,
)

PARTS = 2  # steps in a sample of what is given back

BODY = """<mujoco><option gravity="0 0 -{gravity}"/><worldbody><body name="upper">
<joint name="shoulder" type="hinge" axis="0 1 0"/>
<inertial pos="0 0 -{c1}" mass="{m1}" diaginertia="{i1} {i1} 1e-5"/>
<body name="fore" pos="0 0 -{l1}"><joint name="elbow" type="hinge" axis="0 1 0"/>
<inertial pos="0 0 -{c2}" mass="{m2}" diaginertia="{i2} {i2} 1e-5"/>
<site name="hand" pos="0 0 -{l2}"/></body></body></worldbody></mujoco>"""


class Arm(NamedTuple):
    """Masses, lengths, distances to the centres of mass and moments of inertia about them.

    rotor   inertia of the driven joint's motor;  viscous, held  of the driven joint, of the other
    driven  0 for the shoulder, 1 for the elbow;  gains of both joints
    locked  whether the other joint is clamped: held by a controller it would swing as on a spring
    """

    m1: float
    m2: float
    l1: float
    l2: float
    c1: float
    c2: float
    i1: float
    i2: float
    gravity: float
    rotor: float
    viscous: float
    held: float
    driven: int
    stiff: float
    damped: float
    other_stiff: float
    other_damped: float
    locked: bool


def draw(rng: np.random.Generator, kinds: frozenset[str], fastest: float) -> Machine:
    """A joint whose body is described; or a bare one, whose other joint is clamped."""
    bare = bool(rng.uniform() < (0.5 if "tip_payload" in kinds else 0.25))
    m1, m2 = rng.uniform(0.5, 3.0), rng.uniform(0.3, 2.0)
    l1, l2 = rng.uniform(0.2, 0.5), rng.uniform(0.2, 0.4)
    c1, c2 = l1 * rng.uniform(0.4, 0.6), l2 * rng.uniform(0.4, 0.6)
    i1, i2 = m1 * l1**2 / 12, m2 * l2**2 / 12
    driven = int(rng.integers(2))
    far = m2 * ((l1 + c2) ** 2 if driven == 0 else c2**2) + i2
    inertia = far + (m1 * c1**2 + i1 if driven == 0 else 0.0)
    rotor = inertia * rng.uniform(0.05, 0.3)
    own = 2 * np.pi * max(3.0 * fastest, 2.5)
    viscous = inertia * 2 * np.pi * fastest * log_uniform(rng, 0.1, 1.0)
    other = (m2 * c2**2 + i2 if driven == 0 else m1 * c1**2 + i1 + m2 * l1**2) + rotor
    gravity = 0.0 if bare else 9.81
    numbers = Arm(
        *(m1, m2, l1, l2, c1, c2, i1, i2, gravity, rotor, viscous, viscous, driven),
        (inertia + rotor) * own**2,
        1.6 * (inertia + rotor) * own,
        4.0 * other * own**2,
        3.2 * other * own,
        bare,
    )
    effort, constant, origin = drawn_effort(rng, kinds, True, voltage=False)
    names = ["shoulder", "elbow"]
    body = {
        "mjcf": "arm.xml",
        "joint": names[driven],
        "joints": {names[1 - driven]: {"column": "other", "unit": "rad"}},
        "tip": "hand",
    }
    described = {} if bare else {"body": body, "known": {"scale": constant}}
    files = {} if bare else {"arm.xml": BODY.format(**numbers._asdict())}
    return Machine(
        "joint",
        True,
        (inertia + rotor) if bare else rotor,
        viscous,
        effort,
        constant,
        origin,
        numbers,
        rng.uniform(1.6, 3.0),
        fastest,
        float(rng.integers(1, 4)),
        described=described,
        files=files,
    )


def play(machine: Machine, hidden: Hidden, plan: Plan) -> Motion:
    """Simulate one log."""
    p, bare = machine.numbers, not machine.files
    h = hidden if bare else hidden._replace(weight=0.0)
    carried = p if bare else loaded(p, hidden.payload)
    around = np.zeros_like(plan.around) if bare else plan.around
    both = (plan.wanted, around) if p.driven == 0 else (around, plan.wanted)
    wanted = np.column_stack([*both, *(np.gradient(w, 1 / FINE) for w in both)])
    q, v, u = _played(wanted, carried, h, memory(), plan.warming, 1.0 / FINE)
    k = p.driven
    if bare:
        return Motion(q[k], v[k], u / machine.constant)

    def known(seen: np.ndarray) -> np.ndarray:
        read = np.array([seen, q[1]] if k == 0 else [q[0], seen])
        speeds = np.gradient(read, 1 / FINE, axis=1)
        rates = np.gradient(speeds, 1 / FINE, axis=1)
        return np.asarray(inverse(read, speeds, rates, p)[k] / machine.constant)

    return Motion(q[k], v[k], u / machine.constant, {"other": q[1 - k]}, known)


def loaded(p: Arm, share: float) -> Arm:
    """The arm with a mass at its tip, a share of that of its last link."""
    more = share * p.m2
    mass = p.m2 + more
    centre = (p.m2 * p.c2 + more * p.l2) / mass
    about = p.i2 + p.m2 * (p.c2 - centre) ** 2 + more * (p.l2 - centre) ** 2
    return p._replace(m2=mass, c2=centre, i2=about)


def inverse(q: np.ndarray, v: np.ndarray, a: np.ndarray, p: Arm) -> np.ndarray:
    """Torques of the links' weight and inertia at their joints, (2, n), without the rotors'."""
    near = p.i2 + p.m2 * p.c2**2
    cross = p.m2 * p.l1 * p.c2
    m11 = p.i1 + p.m1 * p.c1**2 + near + p.m2 * p.l1**2 + 2 * cross * np.cos(q[1])
    m12 = near + cross * np.cos(q[1])
    spin = cross * np.sin(q[1])
    fore = p.m2 * p.c2 * p.gravity * np.sin(q[0] + q[1])
    upper = (p.m1 * p.c1 + p.m2 * p.l1) * p.gravity * np.sin(q[0])
    one = m11 * a[0] + m12 * a[1] - spin * (2 * v[0] + v[1]) * v[1] + upper + fore
    two = m12 * a[0] + near * a[1] + spin * v[0] ** 2 + fore
    return np.array([one, two])


def energy(q: np.ndarray, v: np.ndarray, p: Arm) -> np.ndarray:
    """Kinetic and potential energy of the links, (n,), without the rotors'."""
    near, cross = p.i2 + p.m2 * p.c2**2, p.m2 * p.l1 * p.c2 * np.cos(q[1])
    m11 = p.i1 + p.m1 * p.c1**2 + near + p.m2 * p.l1**2 + 2 * cross
    moving = m11 * v[0] ** 2 / 2 + (near + cross) * v[0] * v[1] + near * v[1] ** 2 / 2
    upper = (p.m1 * p.c1 + p.m2 * p.l1) * p.gravity * np.cos(q[0])
    resting = upper + p.m2 * p.c2 * p.gravity * np.cos(q[0] + q[1])
    return np.asarray(moving - resting)


@njit(cache=True)
def _played(wanted, p, h, cells, warming, period):
    """Angles (2, n), speeds (2, n), and the torque that the driven joint was asked for (n,)."""
    n, dt, k = len(wanted), period / PARTS, p.driven
    angles, speeds, asked = np.empty((2, n)), np.empty((2, n)), np.empty(n)
    q, v, z = wanted[0, :2].copy(), np.zeros(2), 0.0
    near, cross = p.i2 + p.m2 * p.c2 * p.c2, p.m2 * p.l1 * p.c2
    flat = p.i1 + p.m1 * p.c1 * p.c1 + near + p.m2 * p.l1 * p.l1
    push, free = np.zeros(2), np.zeros(2)
    for i in range(n):
        angles[:, i], speeds[:, i] = q, v
        u = p.stiff * (wanted[i, k] - q[k]) + p.damped * (wanted[i, 2 + k] - v[k])
        j = 1 - k
        other = p.other_stiff * (wanted[i, j] - q[j]) + p.other_damped * (wanted[i, 2 + j] - v[j])
        asked[i] = u
        for _ in range(PARTS):
            motor = drive(u, q[k], v[k], cells, h)
            viscous = p.viscous * (1.0 + warming * i / n)
            push[k] = motor + passive(q[k], v[k], cells, h) - viscous * v[k]
            push[j] = other - p.held * v[j]
            spin = cross * math.sin(q[1])
            fore = p.m2 * p.c2 * p.gravity * math.sin(q[0] + q[1])
            upper = (p.m1 * p.c1 + p.m2 * p.l1) * p.gravity * math.sin(q[0])
            push[0] += spin * (2.0 * v[0] + v[1]) * v[1] - upper - fore
            push[1] -= spin * v[0] * v[0] + fore
            m00 = flat + 2.0 * cross * math.cos(q[1]) + p.rotor
            m01, m11 = near + cross * math.cos(q[1]), near + p.rotor
            if p.locked:
                m01, push[j] = 0.0, 0.0
            whole = m00 * m11 - m01 * m01
            free[0] = v[0] + dt * (m11 * push[0] - m01 * push[1]) / whole
            free[1] = v[1] + dt * (m00 * push[1] - m01 * push[0]) / whole
            # what the driven joint gives way to an impulse at it, and the other joint with it
            give = (m11 if k == 0 else m00) / whole
            most = level(q[k], v[k], i * period, motor - viscous * v[k], motor, h)
            if h.way > 0.0:
                z = min(max(z + dt * v[k] / h.way, -1.0), 1.0)
                impulse = -dt * most * z
            else:
                impulse = min(max(-free[k] / give, -dt * most), dt * most)
            v[k] = free[k] + give * impulse
            v[j] = free[j] - m01 / whole * impulse
            q[0] += dt * v[0]
            q[1] += dt * v[1]
            remember(cells, u, v[k], dt, h)
    return angles, speeds, asked


ARM = Simulator("arm", DRIVEN, False, draw, play)
