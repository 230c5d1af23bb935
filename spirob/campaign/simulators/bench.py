"""A bench that imposes the motion: the effort is what the axis asks for, in closed form.

    effort = J·a + b·v + dry friction - further torques

The motion follows the plan exactly, mostly at constant speeds or one way, as on a bench that
measures friction or a cylinder that is stroked.  Dry friction that turns round over a way is a row
of springs that slip one after the other (Maxwell's), another loop than a single bristle's.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from spirob.campaign.simulators.hidden import Hidden, level, memory, passive, remember
from spirob.campaign.simulators.motion import (
    FINE,
    PASSIVE,
    Machine,
    Motion,
    Plan,
    Simulator,
    drawn_effort,
    log_uniform,
)

SPRINGS = np.array([0.3, 0.6, 1.0, 1.5, 2.2])  # ways after which each of them slips


class Bench(NamedTuple):
    """inertia and viscous friction of what is moved."""

    inertia: float
    viscous: float


def draw(rng: np.random.Generator, kinds: frozenset[str], fastest: float) -> Machine:
    """A damper before a load cell, a slide, or a rotary axis."""
    sensor = not any(k in kinds for k in ("current_offset", "current_gain", "current_lag"))
    rig = str(rng.choice(["slide", "rotary bench", *(["damper"] if sensor else [])]))
    angular = rig == "rotary bench"
    inertia = log_uniform(rng, 5e-3, 0.1) if angular else log_uniform(rng, 1.0, 30.0)
    stroke = rng.uniform(2.0, 8.0) if angular else rng.uniform(0.05, 0.6)
    viscous = inertia * 2 * np.pi * fastest * log_uniform(rng, 0.3, 3.0)
    effort, constant, origin = drawn_effort(rng, kinds, angular, voltage=False)
    described = {}
    if rig == "damper":
        effort, constant, origin, inertia = "force", 1.0, "sensor", 0.0
        described = {"known": {"inertia": 0.0}}
    return Machine(
        rig,
        angular,
        inertia,
        viscous,
        effort,
        constant,
        origin,
        Bench(inertia, viscous),
        stroke,
        fastest,
        1.0 if angular else 2 * np.pi / (stroke / rng.uniform(2, 5)),
        ("scan", "moves", "tones", *(["one way"] if angular or "cogging" not in kinds else [])),
        described,
    )


def play(machine: Machine, hidden: Hidden, plan: Plan) -> Motion:
    """Work out one log."""
    p, v = machine.numbers, np.gradient(plan.wanted, 1 / FINE)
    warmer = 1.0 + plan.warming * np.arange(len(v)) / len(v)
    effort = p.inertia * np.gradient(v, 1 / FINE) + p.viscous * warmer * v
    effort += _asked(plan.wanted, v, hidden, memory(), 1.0 / FINE)
    return Motion(plan.wanted, v, effort / machine.constant)


@njit(cache=True)
def _asked(q, v, h, cells, period):
    """Dry friction less further torques along a motion, (n,)."""
    out = np.empty(len(q))
    bends = np.zeros(len(SPRINGS))
    way, sign = h.way, 0.0
    for k in range(len(q)):
        if v[k] != 0.0:
            sign = 1.0 if v[k] > 0.0 else -1.0
        share = sign
        if way > 0.0:
            share = 0.0
            for i in range(len(SPRINGS)):
                bends[i] = min(max(bends[i] + period * v[k] / (way * SPRINGS[i]), -1.0), 1.0)
                share += bends[i] / len(SPRINGS)
        rub = level(q[k], v[k], k * period, 0.0, 0.0, h) * share
        out[k] = rub - passive(q[k], v[k], cells, h)
        remember(cells, 0.0, v[k], period, h)
    return out


BENCH = Simulator("bench", PASSIVE, False, draw, play)
