"""A motor and its load, with a spring and play between them, and a winding behind a current loop.

    L·i' = U - R·i - k·v,   J·v' = τ(k·i) - b·v - p - friction,   J_l·v_l' = p + further torques

p is what the spring passes: c·φ + d·φ' beyond the play on the side of the flank that touches, and
nothing within it or where the flanks would have to pull.  Runge and Kutta's fourth order; a step in
which a flank begins or ceases to touch is divided there.  Dry friction is at the motor, with a
smooth sign, or with Dahl's bristle where it turns round over a way.
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

PARTS = 4  # steps in a sample of what is given back
STIFF = 150.0  # Hz, at which the load swings on a shaft that counts as rigid
HALVINGS = 20  # of a step in which a flank touches
Q, V, LOAD_Q, LOAD_V, CURRENT, BRISTLE = range(6)


class TwoMass(NamedTuple):
    """motor, load  inertias;  viscous  of the motor;  damping  ratio of the spring's

    resistance, inductance, constant  of the winding, torque for an ampere;  supply  [V]
    stiff, damped  gains of the position loop;  slow  speed in which the sign of friction turns
    """

    motor: float
    load: float
    viscous: float
    damping: float
    resistance: float
    inductance: float
    constant: float
    supply: float
    stiff: float
    damped: float
    slow: float
    at_load: bool
    volts: bool


def draw(rng: np.random.Generator, kinds: frozenset[str], fastest: float) -> Machine:
    """A servo whose load is about as heavy as its motor; its sensor is at either of them."""
    inertia, share = log_uniform(rng, 5e-3, 0.1), rng.uniform(0.3, 0.75)
    stroke = rng.uniform(2.0, 7.0)
    own = 2 * np.pi * max(3.0 * fastest, 2.0)
    viscous = inertia * 2 * np.pi * fastest * log_uniform(rng, 0.1, 1.0)
    effort, constant, origin = drawn_effort(rng, kinds, True, voltage=True)
    amperes = constant if effort == "current" else log_uniform(rng, 0.2, 2.0)
    # of the voltage at full speed and of the most torque as much is lost in the winding
    speed, torque = np.pi * fastest * stroke, inertia * (np.pi * fastest) ** 2 * stroke
    resistance = amperes**2 * speed / torque * rng.uniform(0.3, 1.0)
    numbers = TwoMass(
        inertia * (1 - share),
        inertia * share,
        viscous,
        rng.uniform(0.03, 0.15),
        resistance,
        resistance * rng.uniform(0.5e-3, 2e-3),
        amperes,
        20.0 * (amperes * speed + resistance * torque / amperes),
        inertia * own**2,
        1.6 * inertia * own,
        0.01 * speed,
        bool(rng.uniform() < 0.35),
        effort == "voltage",
    )
    described, back = {}, 0.0
    if effort == "voltage":
        constant, back = amperes / resistance, amperes**2 / resistance
        if rng.uniform() < 0.5:
            described, back = {"known": {"back_emf": amperes}}, 0.0
    return Machine(
        "two masses",
        True,
        inertia,
        viscous + back,
        effort,
        constant,
        origin,
        numbers,
        stroke,
        fastest,
        float(rng.integers(1, 4)),
        described=described | ({"side": "load"} if numbers.at_load else {}),
    )


def play(machine: Machine, hidden: Hidden, plan: Plan) -> Motion:
    """Simulate one log."""
    p = machine.numbers
    wanted = np.column_stack([plan.wanted, np.gradient(plan.wanted, 1 / FINE)])
    out = _played(wanted, p, hidden, memory(), plan.warming, 1.0 / FINE)
    effort = out[5] if p.volts else out[4] * p.constant / machine.constant
    return Motion(out[2] if p.at_load else out[0], out[1], effort)


@njit(cache=True)
def spring(p, h):
    """Stiffness and damping of what is between motor and load."""
    square = 1.0 / h.soft if h.soft > 0.0 else STIFF * STIFF
    stiffness = p.load * 4.0 * math.pi * math.pi * square
    return stiffness, 2.0 * p.damping * math.sqrt(stiffness * p.load)


@njit(cache=True)
def passed(x, side, p, h):
    """Torque from motor to load while this side touches: 1, -1, or 0 for none."""
    if side == 0.0:
        return 0.0
    stiffness, damping = spring(p, h)
    torque = stiffness * (x[Q] - x[LOAD_Q] - side * 0.5 * h.play)
    torque += damping * (x[V] - x[LOAD_V])
    return side * max(side * torque, 0.0) if h.play > 0.0 else torque


@njit(cache=True)
def touching(x, h):
    """The side that touches; without play one always does."""
    if h.play <= 0.0:
        return 1.0
    behind = x[Q] - x[LOAD_Q]
    if abs(behind) < 0.5 * h.play:
        return 0.0
    return 1.0 if behind > 0.0 else -1.0


@njit(cache=True)
def slope(x, side, volts, viscous, t, cells, p, h):
    """Rates of the state, (6,)."""
    found = np.empty(6)
    between = passed(x, side, p, h)
    motor = drive(p.constant * x[CURRENT], x[Q], x[V], cells, h)
    most = level(x[Q], x[V], t, between, motor, h)
    found[BRISTLE] = (x[V] - abs(x[V]) * x[BRISTLE]) / h.way if h.way > 0.0 else 0.0
    rub = most * (x[BRISTLE] if h.way > 0.0 else math.tanh(x[V] / p.slow))
    found[Q], found[LOAD_Q] = x[V], x[LOAD_V]
    found[V] = (motor - viscous * x[V] - rub - between) / p.motor
    found[LOAD_V] = (between + passive(x[LOAD_Q], x[LOAD_V], cells, h)) / p.load
    found[CURRENT] = (volts - p.resistance * x[CURRENT] - p.constant * x[V]) / p.inductance
    return found


@njit(cache=True)
def step(x, side, dt, volts, viscous, t, cells, p, h):
    """The state after dt, by Runge and Kutta."""
    one = slope(x, side, volts, viscous, t, cells, p, h)
    two = slope(x + 0.5 * dt * one, side, volts, viscous, t, cells, p, h)
    three = slope(x + 0.5 * dt * two, side, volts, viscous, t, cells, p, h)
    four = slope(x + dt * three, side, volts, viscous, t, cells, p, h)
    return x + dt / 6.0 * (one + 2.0 * two + 2.0 * three + four)


@njit(cache=True)
def advance(x, dt, volts, viscous, t, cells, p, h):
    """The state after dt, divided where a flank begins or ceases to touch."""
    side = touching(x, h)
    end = step(x, side, dt, volts, viscous, t, cells, p, h)
    if touching(end, h) == side:
        return end
    low, high = 0.0, dt
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if touching(step(x, side, middle, volts, viscous, t, cells, p, h), h) == side:
            low = middle
        else:
            high = middle
    there = step(x, side, high, volts, viscous, t, cells, p, h)
    return step(there, touching(there, h), dt - high, volts, viscous, t + high, cells, p, h)


@njit(cache=True)
def _played(wanted, p, h, cells, warming, period):
    """Angle and speed of the motor, of the load, current, mean voltage; each (n,)."""
    n, dt = len(wanted), period / PARTS
    out = np.empty((6, n))
    x = np.zeros(6)
    x[Q] = x[LOAD_Q] = wanted[0, 0]
    wound, volts = 0.0, 0.0
    gain = p.inductance * 2.0 * math.pi * 400.0  # a current loop of 400 Hz
    for k in range(n):
        out[:5, k] = x[:5]
        asked = p.stiff * (wanted[k, 0] - x[Q]) + p.damped * (wanted[k, 1] - x[V])
        viscous, mean = p.viscous * (1.0 + warming * k / n), 0.0
        for _ in range(PARTS):
            error = asked / p.constant - x[CURRENT]
            volts = gain * error + wound
            if abs(volts) < p.supply:
                wound += dt * gain * p.resistance / p.inductance * error
            volts = min(max(volts, -p.supply), p.supply)
            mean += volts / PARTS
            x = advance(x, dt, volts, viscous, k * period, cells, p, h)
            remember(cells, p.constant * x[CURRENT], x[V], dt, h)
        out[5, k] = mean
    return out


TWO_MASS = Simulator("two_mass", DRIVEN | {"gear_compliance", "backlash"}, False, draw, play)
