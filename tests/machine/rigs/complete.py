"""Machines from which nothing is missing, however their logs look."""

import numpy as np

from tests.machine.rigs.axis import Case, description, driven, reference, trials_of


def nothing_missing(seed: int) -> Case:
    """Inertia and viscous friction far from nominal, noise, and that is all."""
    rng = np.random.default_rng(seed)
    inertia, viscous = rng.uniform(0.003, 0.05), rng.uniform(0.02, 0.2)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        follow = reference(rng, 1.5, 1.2)
        return driven(lambda q, v, t, u: -viscous * v, follow, inertia, (4.0, 0.8))

    trials = trials_of(make, rng, 0.005)
    return Case(description(), trials[:2], trials[2], {"nothing_missing"})


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

    trials = trials_of(make, rng, 0.002)
    return Case(description(), trials[:2], trials[2], {"nothing_missing"})


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

    trials = trials_of(make, rng, 0.003)
    for trial in trials:
        trial["q"] = np.round(trial["q"] / (2 * np.pi / 1024)) * 2 * np.pi / 1024
    rig = {k: v for k, v in description().items() if k != "filter"}
    return Case(rig, trials[:2], trials[2], {"nothing_missing"})
