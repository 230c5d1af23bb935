"""Are the intervals honest?  How often a true number lies in its 95 % interval.

The model itself plays two short trials with numbers drawn around the nominal ones; its logs are
recorded and decoded like any other, counts included, with noise on the current; and the default set
of numbers is fitted.  The search begins at the true numbers: what is asked here is whether the
optimum lies as near to them as its intervals say, not whether a search finds it.

    python -m spirob.benchmark.coverage --truths 6 --json FILE
"""

import argparse
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed

from spirob.benchmark.timing import moving, recorded
from spirob.can_protocol import AMPERE_PER_COUNT
from spirob.ending import end_with_parent
from spirob.files import write_text
from spirob.identify.fit import STEPS, Fit, fit, polished
from spirob.identify.measurement import Measurement
from spirob.identify.residual import Residual
from spirob.parameter import Table
from spirob.plant import Plant, Rig
from spirob.trials.simulation import SimulatedRobot

# standard deviation of a draw: of the logarithm where a number spans decades, otherwise of itself
SPREADS = {
    "winch.efficiency": 0.035,
    "motor.rotor_damping": 0.4,
    "motor.rotor_inertia": 0.2,
    "arm.base_stiffness": 0.15,
    "arm.damping_time": 0.2,
    "arm.bends_per_hinge": 0.2,
    "tendon.stiffness": 0.1,
    "winch.efficiency_difference": 0.01,
    "motor.rotor_damping_difference": 0.05,
    "motor.rotor_inertia_difference": 0.02,
}
NOISE = 0.005  # A, of the current sensor
LOSS_SCALE = 0.05  # A
SECONDS = 3.0  # of each of two trials
REPEATS = 17  # draws of noise with the same true numbers

Draw = dict[str, dict[str, float]]


def drawn(table: Table, names: Sequence[str], seed: int) -> dict[str, float]:
    """True numbers of one draw, cut at two deviations and to their bounds."""
    random = np.random.default_rng([seed, 3])
    found = {}
    for name in names:
        about, value = table.about[name], float(table.values[table.position(name)])
        shift = SPREADS[name] * float(np.clip(random.standard_normal(), -2.0, 2.0))
        moved = value * np.exp(shift) if about.log else value + shift
        found[name] = float(np.clip(moved, about.low, about.high))
    return found


def one(
    seed: int, names: Sequence[str], repeats: int = REPEATS, seconds: float = SECONDS
) -> list[Draw]:
    """Draws with the same true numbers: of each number the truth, the value found, its interval.

    They differ in the sensors' noise alone, which no controller hears.  The first is fitted; the
    others go on from there with its derivatives, each to an optimum of its own.
    """
    plant = Plant(Rig())
    true = drawn(plant.table, names, seed)
    trials = [moving(f"{side}_pulls", side, seconds) for side in ("left", "right")]
    quiet = recorded(SimulatedRobot(plant, true), trials, plant.rig)
    random = np.random.default_rng([seed, 4])
    found: list[Fit] = []
    for _ in range(repeats):
        residual = Residual(plant, [noisy(trial, NOISE, random) for trial in quiet], workers=1)
        if found:
            begun = replace(found[0], residual=residual(found[0].changes))
        else:
            begun = fit(residual, names, true, LOSS_SCALE, iterations=1, steps=STEPS[-1:])
        found.append(polished(residual, begun, LOSS_SCALE))
    return [
        {n: {"true": true[n], "value": e.value, "low": e.low, "high": e.high} for n, e in f.items()}
        for f in (one.estimates for one in found)
    ]


def noisy(trial: Measurement, noise: float, random: np.random.Generator) -> Measurement:
    """The same with white noise of this deviation [A] on both current sensors, in whole counts.

    No controller hears it: they feed back displacement and velocity.
    """
    counts = np.round(random.normal(0.0, noise / AMPERE_PER_COUNT, trial.current.shape))
    return replace(trial, current=trial.current + counts * AMPERE_PER_COUNT)


def coverage(draws: Sequence[Draw]) -> dict[str, Any]:
    """Share of draws whose truth lies in the interval, by number and over all.

    width  median of half the interval over the true value (or itself, for a difference)
    """
    out = {}
    for name in draws[0]:
        inside = [d[name]["low"] <= d[name]["true"] <= d[name]["high"] for d in draws]
        half = [0.5 * (d[name]["high"] - d[name]["low"]) for d in draws]
        size = [1.0 if name.endswith("_difference") else d[name]["true"] for d in draws]
        out[name] = {
            "inside": float(np.mean(inside)),
            "width": float(f"{np.median(np.array(half) / size):.3g}"),
        }
    return {
        "draws": len(draws),
        "inside": float(np.mean([n["inside"] for n in out.values()])),
        "numbers": out,
    }


def measure(
    truths: int, repeats: int = REPEATS, names: Sequence[str] = tuple(SPREADS), jobs: int = 1
) -> dict[str, Any]:
    """Coverage over so many sets of true numbers and draws of noise with each, in parallel."""
    tasks = (delayed(one)(seed, names, repeats) for seed in range(truths))
    found = Parallel(n_jobs=jobs, initializer=end_with_parent)(tasks)
    return coverage([draw for draws in found for draw in draws])


def main(arguments: list[str] | None = None) -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(prog="spirob.benchmark.coverage", description=__doc__)
    parser.add_argument("--truths", type=int, default=6)
    parser.add_argument("--repeats", type=int, default=REPEATS)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--json", type=Path, help="file to write the figures to")
    chosen = parser.parse_args(arguments)
    found = measure(chosen.truths, chosen.repeats, jobs=chosen.jobs)
    text = json.dumps(found, indent=1)
    print(text)
    if chosen.json:
        write_text(chosen.json, text + "\n")


if __name__ == "__main__":
    main()
