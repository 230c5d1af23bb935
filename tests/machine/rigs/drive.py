"""Machines whose drive or reading is not what its model says."""

import numpy as np

from tests.machine.rigs.axis import RATE, Case, description, driven, reference, trials_of


def saturating(seed: int) -> Case:
    """A motor whose iron saturates: torque is level in the end, by a tanh of the current."""
    rng = np.random.default_rng(seed)
    inertia, viscous, constant = rng.uniform(0.02, 0.06), 0.05, rng.uniform(0.1, 0.3)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        follow = reference(rng, 2.0, 1.2)
        made = driven(lambda q, v, t, u: -viscous * v, follow, inertia, (6.0, 1.0))
        # the start, where the reference jumps, is no part of a log
        return {name: values[500:] for name, values in made.items()}

    trials = trials_of(make, rng, 0.0)
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
    """A drive that reports its current through two stages of smoothing, logged without a delay."""
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

    trials = trials_of(make, rng, 0.004)
    return Case(
        description(known={"delay": 0.0}), trials[:2], trials[2], {"named"}, [{"current_lag"}]
    )


def late(seed: int) -> Case:
    """A position that arrives late, in a log whose channels are known to be of one moment."""
    rng = np.random.default_rng(seed)
    inertia, viscous, age = rng.uniform(0.02, 0.05), 0.1, rng.uniform(0.005, 0.0075)

    def make(rng: np.random.Generator) -> dict[str, np.ndarray]:
        follow = reference(rng, 1.5, 1.5)
        made = driven(lambda q, v, t, u: -viscous * v, follow, inertia, (5.0, 0.8))
        return {**made, "q": np.interp(made["t"] - age, made["t"], made["q"])}

    trials = trials_of(make, rng, 0.004)
    return Case(
        description(known={"delay": 0.0}), trials[:2], trials[2], {"named"}, [{"feedback_latency"}]
    )
