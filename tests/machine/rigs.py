"""Machines that are not ours, simulated by equations of their own.

Nothing of the library is used here: bristle friction after Canudas de Wit, drag, magnets, dampers
and a pendulum are written out again, in richer forms where there are any.  Every function gives
the description of the rig, its logs (training trials and a held-out one) as columns, and what the
right answer is.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

STEP = 2e-4  # s, of the simulation
RATE = 500  # Hz, of the log
LENGTH = 10.0  # s

PENDULUM = """<mujoco><option gravity="0 0 -9.81"/><worldbody><body name="link">
<joint name="shoulder" type="hinge" axis="0 1 0"/>
<inertial pos="0 0 -0.15" mass="0.4" diaginertia="0.003 0.003 0.0001"/>
<site name="hand" pos="0 0 -0.3"/></body></worldbody></mujoco>"""


@dataclass
class Case:
    """A rig with its logs and its right answer.

    verdicts  that are right;  must  groups of effects, one of each has to be named
    files     further files of the description, name -> text
    """

    rig: dict
    train: list[dict[str, np.ndarray]]
    test: dict[str, np.ndarray]
    verdicts: set[str]
    must: list[set[str]] = field(default_factory=list)
    files: dict[str, str] = field(default_factory=dict)


def reference(rng: np.random.Generator, size: float, fastest: float) -> Callable[[float], float]:
    """A wandering reference: a few tones below `fastest` [Hz], from rest."""
    tones = rng.uniform(0.08, fastest, 4)
    weights = size * rng.uniform(0.5, 1.0, 4) / (1 + 2 * tones)
    phases = rng.uniform(0, 2 * np.pi, 4)

    def at(t: float) -> float:
        return float(np.sum(weights * (np.sin(2 * np.pi * tones * t + phases) - np.sin(phases))))

    return at


def driven(
    torque_on: Callable[[float, float, float, float], float],
    follow: Callable[[float], float],
    inertia: float,
    gains: tuple[float, float],
) -> dict[str, np.ndarray]:
    """An axis under a position controller, semi-implicit Euler.

    torque_on  (q, v, t, effort) -> torque beside the motor's;  gains  of position and speed
    """
    q = v = 0.0
    steps, every = round(LENGTH / STEP), round(1 / (RATE * STEP))
    rows = []
    for k in range(steps):
        t = k * STEP
        if k % every == 0:
            wanted = follow(t)
            rate = (follow(t + 1e-4) - wanted) / 1e-4
            effort = gains[0] * (wanted - q) + gains[1] * (rate - v)
            rows.append((t, q, v, effort))
        v += STEP * (effort + torque_on(q, v, t, effort)) / inertia
        q += STEP * v
    t, q_log, _, effort_log = np.array(rows).T
    return {"t": t, "q": q_log, "u": effort_log}


def description(**changes: object) -> dict:
    """A rotary rig with torque as effort; `changes` replace its keys."""
    base: dict = {
        "name": "synthetic",
        "time": {"column": "t", "unit": "s"},
        "position": {"column": "q", "unit": "rad"},
        "effort": {"column": "u", "unit": "N·m", "kind": "torque"},
        "fit": {
            "inertia": {"nominal": 0.01, "low": 1e-4, "high": 1.0},
            "viscous": {"nominal": 0.05, "low": 0.0, "high": 5.0},
        },
        "filter": {"cutoff": 30.0},
    }
    return {**base, **changes}


def _trials(
    make: Callable[[np.random.Generator], dict[str, np.ndarray]],
    rng: np.random.Generator,
    noise: float,
    count: int = 3,
) -> list[dict[str, np.ndarray]]:
    trials = [make(rng) for _ in range(count)]
    for trial in trials:
        trial["u"] = trial["u"] + noise * rng.standard_normal(len(trial["u"]))
        trial["q"] = np.round(trial["q"] / 2e-5) * 2e-5 + 1e-6  # an encoder counts
    return trials


def nothing_missing(seed: int) -> Case:
    """Inertia and viscous friction far from nominal, noise, and that is all."""
    rng = np.random.default_rng(seed)
    inertia, viscous = rng.uniform(0.003, 0.05), rng.uniform(0.02, 0.2)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        follow = reference(rng, 1.5, 1.2)
        return driven(lambda q, v, t, u: -viscous * v, follow, inertia, (4.0, 0.8))

    trials = _trials(make, rng, 0.005)
    return Case(description(), trials[:2], trials[2], {"nothing_missing"})


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

    trials = _trials(make, rng, 0.005)
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

    trials = _trials(make, rng, 0.01)
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

    trials = _trials(make, rng, 0.5)
    for trial in trials:
        trial["q"] = 1e3 * (np.round(trial["q"] / 1e-6) * 1e-6) + 1e-4
    rig = description(
        position={"column": "q", "unit": "mm"},
        effort={"column": "u", "unit": "N", "kind": "force", "origin": "sensor"},
        known={"inertia": 0.0},
        fit={"viscous": {"nominal": 500.0, "low": 0.0, "high": 1e4}},
    )
    return Case(rig, trials[:2], trials[2], {"named"}, [{"coulomb_friction"}])


def pendulum(seed: int) -> Case:
    """A joint that swings a link known as MJCF, with something in its hand that is not."""
    rng = np.random.default_rng(seed)
    payload, viscous = rng.uniform(0.08, 0.25), rng.uniform(0.02, 0.08)
    inertia = 0.003 + 0.4 * 0.15**2 + payload * 0.3**2
    weight = 9.81 * (0.4 * 0.15 + payload * 0.3)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        def torque(q: float, v: float, t: float, u: float) -> float:
            return -viscous * v - weight * np.sin(q)

        return driven(torque, reference(rng, 1.2, 0.9), inertia, (25.0, 2.0))

    trials = _trials(make, rng, 0.02)
    rig = description(
        body={"mjcf": "link.xml", "joint": "shoulder", "tip": "hand"},
        fit={"viscous": {"nominal": 0.1, "low": 0.0, "high": 5.0}},
    )
    files = {"link.xml": PENDULUM}
    return Case(rig, trials[:2], trials[2], {"named"}, [{"tip_payload"}], files)


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

    trials = _trials(make, rng, 0.01)
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


def magnets(seed: int) -> Case:
    """Magnets whose spacing shrinks along the way: periodic in no angle, and in no library."""
    rng = np.random.default_rng(seed)
    viscous, strength, pitch = 0.05, rng.uniform(0.15, 0.3), rng.uniform(1.2, 2.0)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        def torque(q: float, v: float, t: float, u: float) -> float:
            return -viscous * v - strength * np.sin(pitch * q * (1 + abs(q)))

        return driven(torque, reference(rng, 2.0, 0.8), 0.01, (8.0, 0.8))

    trials = _trials(make, rng, 0.01)
    return Case(description(), trials[:2], trials[2], {"unknown"})


def coloured(seed: int) -> Case:
    """Nothing is missing, but the effort carries slow noise as large as an effect."""
    rng = np.random.default_rng(seed)
    inertia, viscous = rng.uniform(0.005, 0.03), rng.uniform(0.05, 0.2)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        follow = reference(rng, 1.5, 1.0)
        made = driven(lambda q, v, t, u: -viscous * v, follow, inertia, (4.0, 0.8))
        size = 0.05 * np.std(made["u"])
        drift = np.zeros(len(made["u"]))
        for k in range(1, len(drift)):
            drift[k] = 0.98 * drift[k - 1] + 0.2 * size * rng.standard_normal()
        return {**made, "u": made["u"] + drift}

    trials = _trials(make, rng, 0.002)
    return Case(description(), trials[:2], trials[2], {"nothing_missing"})


def saturating(seed: int) -> Case:
    """A motor whose iron saturates: torque is level in the end, by a tanh of the current."""
    rng = np.random.default_rng(seed)
    inertia, viscous, constant = rng.uniform(0.02, 0.06), 0.05, rng.uniform(0.1, 0.3)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        follow = reference(rng, 2.0, 1.2)
        made = driven(lambda q, v, t, u: -viscous * v, follow, inertia, (6.0, 1.0))
        # the start, where the reference jumps, is no part of a log
        return {name: values[500:] for name, values in made.items()}

    trials = _trials(make, rng, 0.0)
    # one motor for all trials, never asked for more than it has
    most = rng.uniform(1.1, 1.6) * max(float(np.max(np.abs(x["u"]))) for x in trials)
    for trial in trials:
        trial["u"] = most * np.arctanh(trial["u"] / most) / constant
        trial["u"] += 0.01 * np.std(trial["u"]) * rng.standard_normal(len(trial["u"]))
    rig = description(
        effort={"column": "u", "unit": "A", "kind": "current"},
        fit={
            "inertia": {"nominal": 0.1, "low": 1e-3, "high": 10.0},
            "viscous": {"nominal": 0.5, "low": 0.0, "high": 50.0},
        },
    )
    return Case(rig, trials[:2], trials[2], {"named"}, [{"torque_constant_saturation"}])


def smoothed(seed: int) -> Case:
    """A drive that reports its current through two stages of smoothing."""
    rng = np.random.default_rng(seed)
    inertia, viscous, delay = rng.uniform(0.02, 0.05), 0.1, rng.uniform(0.01, 0.03)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        follow = reference(rng, 1.5, 1.5)
        made = driven(lambda q, v, t, u: -viscous * v, follow, inertia, (5.0, 0.8))
        seen = made["u"].copy()
        for share in (0.7, 0.3):
            keep = np.exp(-1 / (RATE * share * delay))
            for k in range(1, len(seen)):
                seen[k] = keep * seen[k - 1] + (1 - keep) * seen[k]
        return {**made, "u": seen}

    trials = _trials(make, rng, 0.004)
    return Case(description(), trials[:2], trials[2], {"named"}, [{"current_lag"}])


def spring(seed: int) -> Case:
    """A progressive spring on a bare axis: the library has springs for hinged bodies only."""
    rng = np.random.default_rng(seed)
    viscous, stiff, cubic = 0.05, rng.uniform(0.1, 0.3), rng.uniform(0.05, 0.2)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        def torque(q: float, v: float, t: float, u: float) -> float:
            return -viscous * v - stiff * q - cubic * q**3

        return driven(torque, reference(rng, 1.5, 0.8), 0.01, (8.0, 0.8))

    trials = _trials(make, rng, 0.01)
    return Case(description(), trials[:2], trials[2], {"unknown"})


def late(seed: int) -> Case:
    """A position that arrives some milliseconds after the effort that the same log shows."""
    rng = np.random.default_rng(seed)
    inertia, viscous, age = rng.uniform(0.02, 0.05), 0.1, rng.uniform(0.005, 0.0075)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        follow = reference(rng, 1.5, 1.5)
        made = driven(lambda q, v, t, u: -viscous * v, follow, inertia, (5.0, 0.8))
        return {**made, "q": np.interp(made["t"] - age, made["t"], made["q"])}

    trials = _trials(make, rng, 0.004)
    return Case(description(), trials[:2], trials[2], {"named"}, [{"feedback_latency"}])


def coarse(seed: int) -> Case:
    """Nothing is missing: an encoder of 1024 counts, steps with holds, effort held for 4 ms."""
    rng = np.random.default_rng(seed)
    inertia, viscous = rng.uniform(0.01, 0.03), rng.uniform(0.05, 0.15)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        goals = rng.uniform(-1.5, 1.5, 8)

        def follow(t: float) -> float:
            k, x = int(t // 1.5), min(1.0, (t % 1.5) / 0.4)
            before = goals[k - 1] if k else 0.0
            return float(before + (goals[k] - before) * x * x * (3 - 2 * x))

        held = [0.0, 0.0]

        def torque(q: float, v: float, t: float, u: float) -> float:
            if t - held[0] >= 4e-3 or t == 0.0:
                held[:] = [t, u]
            return held[1] - u - viscous * v

        return driven(torque, follow, inertia, (3.0, 0.5))

    trials = _trials(make, rng, 0.003)
    for trial in trials:
        trial["q"] = np.round(trial["q"] / (2 * np.pi / 1024)) * 2 * np.pi / 1024
    rig = {k: v for k, v in description().items() if k != "filter"}
    return Case(rig, trials[:2], trials[2], {"nothing_missing"})


CASES = {
    f.__name__: f
    for f in (
        nothing_missing,
        coloured,
        servo,
        direct_drive,
        damper,
        pendulum,
        crane,
        saturating,
        smoothed,
        magnets,
        spring,
        late,
        coarse,
    )
}
