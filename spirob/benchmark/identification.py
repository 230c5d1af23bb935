"""Identification against `mujoco.sysid` on the same trials.

Both fit η, b_m and J_m from the same start.  `mujoco.sysid` knows no drive and no elastic tendon:
there the rotor is the tendon's armature J_eq/r² and damping b_eq/r², the measured current is the
input and the measured displacement the output.  Errors are the largest relative error of a fitted
number against the one that the data were made with.
"""

from collections.abc import Mapping

import numpy as np

from spirob.bench.simulate import simulate
from spirob.benchmark import sysid
from spirob.benchmark.trials import moving
from spirob.benchmark.turns import Size, in_turns, ratio
from spirob.identify.fit import fit
from spirob.identify.measurement import Measurement
from spirob.identify.residual import Residual
from spirob.plant import Plant, Rig

NAMES = ("winch.efficiency", "motor.rotor_damping", "motor.rotor_inertia")
TRUTH = {
    "winch.efficiency": 0.88,
    "motor.rotor_damping": 1.6e-4,
    "motor.rotor_inertia": 3e-5,
}
NOISE = 0.01  # A, of the current sensor
LOSS_SCALE = 0.05  # A


def measure(size: Size) -> dict[str, float]:
    """`identify_speedup_over_mujoco_sysid` [-] and both errors [-]."""
    plant = Plant(Rig())
    trials = [moving(f"{side}_pulls", side, 2.0 * size.seconds) for side in ("left", "right")]
    data = [
        Measurement.from_trace(simulate(plant, trial, TRUTH, NOISE, seed))
        for seed, trial in enumerate(trials)
    ]
    found: dict[str, Mapping[str, float]] = {}

    def ours() -> None:
        estimates = fit(Residual(plant, data), NAMES, {}, LOSS_SCALE).estimates
        found["ours"] = {name: e.value for name, e in estimates.items()}

    def theirs() -> None:
        found["theirs"] = sysid.fit(plant, data, NAMES)

    taken = in_turns({"ours": ours, "theirs": theirs}, size.slow_repeats)
    return {
        "identify_speedup_over_mujoco_sysid": ratio(taken, "theirs", "ours"),
        "identify_error": _worst(found["ours"]),
        "mujoco_sysid_error": _worst(found["theirs"]),
        "identify_seconds": float(np.median(taken["ours"])),
        "mujoco_sysid_seconds": float(np.median(taken["theirs"])),
    }


def _worst(values: Mapping[str, float]) -> float:
    return max(abs(values[name] / TRUTH[name] - 1.0) for name in NAMES)
