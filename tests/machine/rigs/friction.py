"""Machines with friction that their model does not know."""

import numpy as np

from tests.machine.rigs.axis import (
    LENGTH,
    RATE,
    STEP,
    Case,
    description,
    driven,
    reference,
    trials_of,
)


def servo(seed: int) -> Case:
    """A servo with bristle friction (LuGre) and cogging; the log has current in mA."""
    rng = np.random.default_rng(seed)
    inertia, viscous, constant = 0.004, rng.uniform(0.005, 0.03), rng.uniform(0.2, 0.5)
    level, breakaway = rng.uniform(0.04, 0.08), rng.uniform(1.05, 1.3)
    stiffness, damping, stribeck = 60.0, 0.15, 0.15
    order, cogging = rng.integers(5, 13), rng.uniform(0.02, 0.05)
    phase, second = rng.uniform(0, 6), rng.uniform(0.1, 0.4)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        bristle = [0.0]

        def torque(q: float, v: float, t: float, u: float) -> float:
            sliding = level * (1 + (breakaway - 1) * np.exp(-((v / stribeck) ** 2)))
            # implicit: at speed a bristle settles within a step
            following = (bristle[0] + STEP * v) / (1 + STEP * stiffness * abs(v) / sliding)
            rate = (following - bristle[0]) / STEP
            bristle[0] = following
            rub = stiffness * bristle[0] + damping * rate * 0.1 + viscous * v
            wave = np.sin(order * q + phase) + second * np.sin(2 * order * q)
            return -rub - cogging * wave

        made = driven(torque, reference(rng, 3.0, 0.8), inertia, (3.0, 0.3))
        return {**made, "u": made["u"] / constant}

    trials = trials_of(make, rng, 0.005)
    for trial in trials:
        trial["u"] = 1e3 * trial["u"]
    rig = description(
        effort={"column": "u", "unit": "mA", "kind": "current"},
        fit={
            "inertia": {"nominal": 0.02, "low": 1e-4, "high": 1.0},
            "viscous": {"nominal": 0.05, "low": 0.0, "high": 5.0},
        },
    )
    dry = {"coulomb_friction", "stribeck_friction", "presliding_friction"}
    return Case(rig, trials[:2], trials[2], {"named"}, [{"cogging"}, dry])


def direct_drive(seed: int) -> Case:
    """A fan on a direct drive: drag with the square of the speed."""
    rng = np.random.default_rng(seed)
    inertia, viscous, drag = rng.uniform(0.01, 0.03), 0.01, rng.uniform(0.003, 0.008)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        def torque(q: float, v: float, t: float, u: float) -> float:
            return -viscous * v - drag * abs(v) * v

        return driven(torque, reference(rng, 12.0, 0.5), inertia, (4.0, 0.8))

    trials = trials_of(make, rng, 0.01)
    return Case(description(), trials[:2], trials[2], {"named"}, [{"quadratic_drag"}])


def damper(seed: int) -> Case:
    """A damper on a test bench: imposed motion in mm, force from a load cell, no inertia."""
    rng = np.random.default_rng(seed)
    viscous, seal = rng.uniform(300.0, 900.0), rng.uniform(8.0, 25.0)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        follow = reference(rng, 0.03, 1.5)
        t = np.arange(0, LENGTH, 1 / RATE)
        q = np.array([follow(x) for x in t])
        v = np.array([(follow(x + 1e-5) - follow(x - 1e-5)) / 2e-5 for x in t])
        force = viscous * v + seal * np.clip(v / 4e-4, -1, 1)
        return {"t": t, "q": q, "u": force}

    trials = trials_of(make, rng, 0.5)
    for trial in trials:
        trial["q"] = 1e3 * (np.round(trial["q"] / 1e-6) * 1e-6) + 1e-4
    rig = description(
        position={"column": "q", "unit": "mm"},
        effort={"column": "u", "unit": "N", "kind": "force", "origin": "sensor"},
        known={"inertia": 0.0},
        fit={"viscous": {"nominal": 500.0, "low": 0.0, "high": 1e4}},
    )
    return Case(rig, trials[:2], trials[2], {"named"}, [{"coulomb_friction"}])


def crane(seed: int) -> Case:
    """Two effects in a linear drive that is measured in volt: dry friction and a hanging weight."""
    rng = np.random.default_rng(seed)
    mass, viscous = rng.uniform(5.0, 20.0), rng.uniform(20.0, 80.0)
    dry, weight = rng.uniform(6.0, 15.0), rng.choice([-1, 1]) * rng.uniform(6.0, 15.0)
    volt = rng.uniform(5.0, 20.0)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        def force(q: float, v: float, t: float, u: float) -> float:
            return -viscous * v - dry * float(np.tanh(v / 1e-3)) - weight

        made = driven(force, reference(rng, 0.3, 0.7), mass, (3000.0, 400.0))
        return {**made, "u": made["u"] / volt}

    trials = trials_of(make, rng, 0.01)
    rig = description(
        position={"column": "q", "unit": "m"},
        effort={"column": "u", "unit": "V", "kind": "voltage"},
        fit={
            "inertia": {"nominal": 1.0, "low": 0.01, "high": 100.0},
            "viscous": {"nominal": 5.0, "low": 0.0, "high": 500.0},
        },
    )
    constant = {"constant_force", "current_offset"}
    return Case(rig, trials[:2], trials[2], {"named"}, [{"coulomb_friction"}, constant])
