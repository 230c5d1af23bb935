"""A rigid axis under a digital controller: semi-implicit Euler, friction of bristles (LuGre).

    J·v' = τ(u) - b·v - F·z - σ₁(v)·z'·w + further torques,   z' = (v - |v|·z)/w

τ is the motor's torque, F the level of dry friction, z the share of it that is mobilised after
Canudas de Wit and others (1995), w the way over which it turns round, and σ₁(v) damps the bristles
near rest, critically by half.  Speed and bristles are taken at the end of a step, torques at its
beginning.
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


class Rigid(NamedTuple):
    """inertia, viscous; way of the bristles; samples between two looks of the controller; gains."""

    inertia: float
    viscous: float
    way: float
    hold: int
    stiff: float
    damped: float
    back: float


def draw(rng: np.random.Generator, kinds: frozenset[str], fastest: float) -> Machine:
    """A servo, a direct drive or a slide."""
    rigs = ["servo", "direct drive", *([] if "tip_payload" in kinds else ["slide"])]
    rig = str(rng.choice(rigs))
    angular = rig != "slide"
    inertia = log_uniform(rng, 2e-3, 0.1) if angular else log_uniform(rng, 1.0, 30.0)
    stroke = rng.uniform(2.0, 8.0) if angular else rng.uniform(0.1, 0.8)
    viscous = inertia * 2 * np.pi * fastest * log_uniform(rng, 0.1, 1.5)
    own = 2 * np.pi * max(3.0 * fastest, 2.0)
    turn = {"servo": float(rng.integers(2, 5)), "direct drive": 1.0}.get(
        rig, 2 * np.pi / (stroke / rng.uniform(2, 5))
    )
    effort, constant, origin = drawn_effort(rng, kinds, angular, voltage=True)
    numbers = Rigid(
        inertia,
        viscous,
        1e-3 * stroke * log_uniform(rng, 0.3, 2.0),
        int(rng.choice([2, 5, 10])),
        inertia * own**2,
        1.6 * inertia * own,
        viscous * rng.uniform(0.2, 1.0) if effort == "voltage" else 0.0,
    )
    motions = ("tones", "moves", "sweep", *(["one way"] if rig == "direct drive" else []))
    return Machine(
        rig,
        angular,
        inertia,
        viscous + numbers.back,
        effort,
        constant,
        origin,
        numbers,
        stroke,
        fastest,
        turn,
        motions,
        {"known": {"back_emf": numbers.back / constant}}
        if effort == "voltage" and rng.uniform() < 0.5
        else {},
    )


def play(machine: Machine, hidden: Hidden, plan: Plan) -> Motion:
    """Simulate one log."""
    p = machine.numbers
    wanted = np.column_stack([plan.wanted, np.gradient(plan.wanted, 1 / FINE)])
    ahead = np.zeros(len(wanted)) if plan.ahead is None else plan.ahead
    q, v, u = _played(wanted, ahead, p, hidden, memory(), plan.warming, 1.0 / FINE)
    return Motion(q, v, (u + p.back * v) / machine.constant)


@njit(cache=True)
def _played(wanted, ahead, p, h, cells, warming, period):
    """Position, speed and asked torque, each (n,)."""
    n, dt = len(wanted), period / PARTS
    out = np.empty((3, n))
    q, v, z, asked = wanted[0, 0], 0.0, 0.0, 0.0
    way = h.way if h.way > 0.0 else p.way
    torque = 0.0
    for k in range(n):
        t = k * period
        if k % p.hold == 0:
            asked = p.stiff * (wanted[k, 0] - q) + p.damped * (wanted[k, 1] - v)
            asked += ahead[k]
        out[0, k], out[1, k], out[2, k] = q, v, asked
        viscous = p.viscous * (1.0 + warming * k / n)
        for _ in range(PARTS):
            motor = drive(asked, q, v, cells, h)
            most = level(q, v, t, torque, motor, h)
            settle = abs(v) * dt / way
            z = (z + v * dt / way) / (1.0 + settle)
            damping = math.sqrt(most * p.inertia / way) * math.exp(-((v / way / 20.0) ** 2))
            damping *= 1.0 - math.copysign(z, v * z)
            free = motor - most * z + passive(q, v, cells, h)
            before = v
            v = (v + dt * free / p.inertia) / (1.0 + dt * (viscous + damping) / p.inertia)
            torque = p.inertia * (v - before) / dt + h.weight * math.sin(q - h.hangs)
            q += dt * v
            remember(cells, asked, v, dt, h)
    return out[0], out[1], out[2]


RIGID = Simulator("rigid", DRIVEN, True, draw, play)
