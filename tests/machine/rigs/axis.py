"""An axis under a controller, simulated and logged, and how a rig of it is described."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

STEP = 2e-4  # s, of the simulation
RATE = 500  # Hz, of the log
LENGTH = 10.0  # s


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


def trials_of(
    make: Callable[[np.random.Generator], dict[str, np.ndarray]],
    rng: np.random.Generator,
    noise: float,
    count: int = 3,
) -> list[dict[str, np.ndarray]]:
    """Trials with noise on the effort and an encoder that counts."""
    trials = [make(rng) for _ in range(count)]
    for trial in trials:
        trial["u"] = trial["u"] + noise * rng.standard_normal(len(trial["u"]))
        trial["q"] = np.round(trial["q"] / 2e-5) * 2e-5 + 1e-6  # an encoder counts
    return trials
