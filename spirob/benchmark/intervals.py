"""How near to the truth fitted numbers are: by their intervals, and with a known weight.

    python -m spirob.benchmark.intervals coverage --truths 6 --json FILE
    python -m spirob.benchmark.intervals weight --seeds 1 2 3 --json FILE

`coverage`: how often a true number lies in its 95 % interval.  The model itself plays two short
trials with numbers drawn around the nominal ones; its logs are recorded and decoded like any other,
counts included, with noise on the current; and the default set of numbers is fitted.  The search
begins at the true numbers: what is asked here is whether the optimum lies as near to them as its
intervals say, not whether a search finds it.

`weight`: what is found on emulated robots that hide nothing, without and with a known weight.
Current alone carries no scale of force: without a weight J, b and k are known over η k_t only.  A
kilogram on the drum adds m g r/(η G k_t), which fixes η k_t, with k_t from the data sheet η, and
with it all others.  The robot has its own physics; its truth is read for scoring alone.
"""

import argparse
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed

from spirob.benchmark.timing import moving, recorded
from spirob.can_protocol import AMPERE_PER_COUNT
from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings
from spirob.ending import end_with_parent
from spirob.files import write_text
from spirob.identify.fit import STEPS, Fit, fit, polished
from spirob.identify.measurement import Measurement
from spirob.identify.residual import Residual
from spirob.parameter import Table
from spirob.plant import Plant, Rig
from spirob.trials import Trial
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


def draws(
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


def coverage(found: Sequence[Draw]) -> dict[str, Any]:
    """Share of draws whose truth lies in the interval, by number and over all.

    width  median of half the interval over the true value (or itself, for a difference)
    """
    out = {}
    for name in found[0]:
        inside = [d[name]["low"] <= d[name]["true"] <= d[name]["high"] for d in found]
        half = [0.5 * (d[name]["high"] - d[name]["low"]) for d in found]
        size = [1.0 if name.endswith("_difference") else d[name]["true"] for d in found]
        out[name] = {
            "inside": float(np.mean(inside)),
            "width": float(f"{np.median(np.array(half) / size):.3g}"),
        }
    return {
        "draws": len(found),
        "inside": float(np.mean([n["inside"] for n in out.values()])),
        "numbers": out,
    }


def covered(
    truths: int, repeats: int = REPEATS, names: Sequence[str] = tuple(SPREADS), jobs: int = 1
) -> dict[str, Any]:
    """Coverage over so many sets of true numbers and draws of noise with each, in parallel."""
    tasks = (delayed(draws)(seed, names, repeats) for seed in range(truths))
    found = Parallel(n_jobs=jobs, initializer=end_with_parent)(tasks)
    return coverage([draw for same in found for draw in same])


WEIGHT = 1.0  # kg
# motor that moves, its (duration [s], length [m]), current of the other motor [A]: low, because
# what both tendons pull together takes away from the stiffness of the arm
BENDS = (
    ("left", ((0.2, 0.0), (2.4, 0.09), (0.4, 0.09), (1.6, 0.05), (0.4, 0.05)), 0.25),
    ("right", ((0.2, 0.0), (1.2, 0.03), (1.0, 0.01), (1.2, 0.035), (0.4, 0.035)), 0.3),
)
FREE = ("motor.rotor_inertia", "motor.rotor_damping", "arm.base_stiffness")
NUMBERS = ("winch.efficiency", *FREE)
FIXED = NUMBERS[:3]  # the paper's η, J_m, b_m


def trials(weight: float) -> list[Trial]:
    """The bends, with a weight [kg] on the motor that moves, or none."""
    found = []
    for motor, moves, current in BENDS:
        other = {"left": "right", "right": "left"}[motor]
        follow = {"kind": "moves", "waypoints": [list(move) for move in moves]}
        hold = {"kind": "constant", "value": current, "blend": 0.2}
        plain = {
            "name": f"{motor}_{'hoists' if weight else 'bends'}",
            "role": "train",
            "duration": round(sum(lasts for lasts, _ in moves), 3),
            "motors": {
                motor: {"mode": "displacement", "current_limit": 5.0, "profile": follow},
                other: {"mode": "current", "current_limit": 5.0, "profile": hold},
            },
        }
        found.append(
            Trial.from_plain(plain | ({"scene": {"weights": {motor: weight}}} if weight else {}))
        )
    return found


def true_numbers(robot: EmulatedRobot, rig: Rig) -> dict[str, float]:
    """The robot's numbers in the model's terms: mean of both sides, drum added to the rotor."""
    numbers = robot.truth()["numbers"]
    mean = {name: float(np.mean(value)) for name, value in numbers.items()}
    drum = mean["winch_inertia"] / mean["gear_ratio"] ** 2
    stiffness = float(robot.truth()["drawn"]["stiffness"][0])
    return {
        "winch.efficiency": mean["efficiency"],
        "motor.rotor_inertia": mean["rotor_inertia"] + drum,
        "motor.rotor_damping": mean["rotor_damping"],
        "arm.base_stiffness": stiffness * rig.arm.base_stiffness,
        "motor.torque_constant": mean["torque_constant"],
    }


def weighed(seed: int) -> dict[str, Any]:
    """Errors of one robot: relative, without a weight of the ratios to η k_t, with it of each."""
    rig = Rig()
    robot = EmulatedRobot(EmulatedRig(), HiddenSettings("none"), seed)
    try:
        plain, hoists = (recorded(robot, trials(weight), rig) for weight in (0.0, WEIGHT))
        true = true_numbers(robot, rig)
    finally:
        robot.close()
    plant = Plant(rig)
    without = _fitted(Residual(plant, plain, workers=1), {})
    known = _fitted(Residual(plant, [*plain, *hoists], workers=1), without.changes)
    return {
        "seed": seed,
        "without": {
            "ratios": _errors(_ratios(without.changes, rig), _ratios(true, rig)),
            "numbers": _errors(without.changes, true),
            "rmse": float(np.sqrt(np.mean(without.residual**2))),
        },
        "with": {
            "ratios": _errors(_ratios(known.changes, rig), _ratios(true, rig)),
            "numbers": _errors(known.changes, true),
            "intervals": {n: [known.estimates[n].low, known.estimates[n].high] for n in NUMBERS},
            "true": true,
            "rmse": float(np.sqrt(np.mean(known.residual**2))),
        },
    }


def _fitted(residual: Residual, start: Mapping[str, float]) -> Fit:
    steps = STEPS[-1:] if start else STEPS[:1]
    found = fit(residual, list(SPREADS), start, LOSS_SCALE, iterations=3, steps=steps)
    return polished(residual, found, LOSS_SCALE)


def _ratios(numbers: Mapping[str, float], rig: Rig) -> dict[str, float]:
    strength = numbers["winch.efficiency"]
    strength *= numbers.get("motor.torque_constant", rig.motor.torque_constant)
    return {name: numbers[name] / strength for name in FREE}


def _errors(found: Mapping[str, float], true: Mapping[str, float]) -> dict[str, float]:
    return {n: float(f"{found[n] / true[n] - 1:.4f}") for n in true if n in found}


def with_weight(seeds: Sequence[int], jobs: int = 1) -> dict[str, Any]:
    """Errors of several robots, and the largest of each kind."""
    tasks = (delayed(weighed)(seed) for seed in seeds)
    robots = list(Parallel(n_jobs=jobs, initializer=end_with_parent)(tasks))
    return {
        "weight_kg": WEIGHT,
        "largest_error_of_ratios_without": _largest(r["without"]["ratios"] for r in robots),
        "largest_error_with": _largest({n: r["with"]["numbers"][n] for n in FIXED} for r in robots),
        "robots": robots,
    }


def _largest(errors: Any) -> float:
    return max(abs(value) for one in errors for value in one.values())


def main(arguments: list[str] | None = None) -> None:
    """Measure, print and write."""
    raw = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(
        prog="spirob.benchmark.intervals", description=__doc__, formatter_class=raw
    )
    parser.add_argument("of", choices=("coverage", "weight"))
    parser.add_argument("--truths", type=int, default=6, help="sets of true numbers, of coverage")
    parser.add_argument("--repeats", type=int, default=REPEATS, help="draws of noise with each")
    parser.add_argument("--seeds", type=int, nargs="*", default=[1, 2, 3], help="of robots, weight")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--json", type=Path, help="file to write the figures to")
    chosen = parser.parse_args(arguments)
    if chosen.of == "coverage":
        found = covered(chosen.truths, chosen.repeats, jobs=chosen.jobs)
    else:
        found = with_weight(chosen.seeds, chosen.jobs)
    text = json.dumps(found, indent=1)
    print(text)
    if chosen.json:
        write_text(chosen.json, text + "\n")


if __name__ == "__main__":
    main()
