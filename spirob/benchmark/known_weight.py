"""What identification finds on emulated robots that hide nothing, without and with a known weight.

Current alone carries no scale of force: without a weight J, b and k are known over η k_t only.  A
kilogram on the drum adds m g r/(η G k_t), which fixes η k_t, with k_t from the data sheet η, and
with it all others.  The robot has its own physics; its truth is read for scoring alone.

    python -m spirob.benchmark.known_weight --seeds 1 2 3 --json FILE
"""

import argparse
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed

from spirob.benchmark.coverage import LOSS_SCALE, SPREADS
from spirob.benchmark.timing import recorded
from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings
from spirob.ending import end_with_parent
from spirob.files import write_text
from spirob.identify.fit import STEPS, Fit, fit, polished
from spirob.identify.residual import Residual
from spirob.plant import Plant, Rig
from spirob.trials import Trial

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


def one(seed: int) -> dict[str, Any]:
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


def measure(seeds: Sequence[int], jobs: int = 1) -> dict[str, Any]:
    """Errors of several robots, and the largest of each kind."""
    tasks = (delayed(one)(seed) for seed in seeds)
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
    parser = argparse.ArgumentParser(prog="spirob.benchmark.known_weight", description=__doc__)
    parser.add_argument("--seeds", type=int, nargs="*", default=[1, 2, 3])
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--json", type=Path, help="file to write the figures to")
    chosen = parser.parse_args(arguments)
    text = json.dumps(measure(chosen.seeds, chosen.jobs), indent=1)
    print(text)
    if chosen.json:
        write_text(chosen.json, text + "\n")


if __name__ == "__main__":
    main()
