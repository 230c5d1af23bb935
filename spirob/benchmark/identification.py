"""Identification against `mujoco.sysid` on the same trials.

Both fit η, b_m and J_m from the same start.  `mujoco.sysid` knows no drive and no elastic tendon:
there the rotor is the tendon's armature J_eq/r² and damping b_eq/r², the measured current is the
input and the measured displacement the output.  Errors are the largest relative error of a fitted
number against the one that the data were made with.

The two do not end at the same error, so two ratios are taken: of the whole fits, ours with its
intervals, which the other does not give; and of the time until ours is for good as near to the
truth as the other ends.
"""

import time
from collections.abc import Mapping

import numpy as np

from spirob.bench.simulate import simulate
from spirob.benchmark import sysid
from spirob.benchmark.trials import moving
from spirob.benchmark.turns import Size, in_turns, ratio
from spirob.identify.descent import robust_cost
from spirob.identify.fit import fit
from spirob.identify.measurement import Measurement
from spirob.identify.residual import Residual
from spirob.plant import Plant, Rig

NAMES = ("winch.efficiency", "motor.rotor_damping", "motor.rotor_inertia")
TRUTH = {
    "winch.efficiency": 0.83,
    "motor.rotor_damping": 1.6e-4,
    "motor.rotor_inertia": 3e-5,
}
NOISE = 0.01  # A, of the current sensor
LOSS_SCALE = 0.05  # A


class Watched(Residual):
    """A residual that notes what its search has found so far, and when.

    found  (time [s], numbers of least cost) after each evaluation of the walk
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        self.begun = time.perf_counter()
        self.found: list[tuple[float, Mapping[str, float]]] = []
        self._least = np.inf

    def __call__(self, changes: Mapping[str, float]) -> np.ndarray:
        """As the residual does."""
        out = super().__call__(changes)
        if (cost := robust_cost(out, LOSS_SCALE)) < self._least:
            self._least = cost
            self.found.append((time.perf_counter() - self.begun, dict(changes)))
        return out

    def near_for_good(self, error: float) -> float:
        """Seconds until the best numbers were within `error`, and remained so; inf if never."""
        since = np.inf
        for seconds, numbers in reversed(self.found):
            if not numbers.keys() >= set(NAMES) or _worst(numbers) > error:
                break
            since = seconds
        return float(since)


def measure(size: Size) -> dict[str, float]:
    """`identify_speedup_over_mujoco_sysid`, `identify_speedup_at_equal_error`, both errors [-]."""
    plant = Plant(Rig())
    trials = [moving(f"{side}_pulls", side, 2.0 * size.seconds) for side in ("left", "right")]
    data = [
        Measurement.from_trace(simulate(plant, trial, TRUTH, NOISE, seed))
        for seed, trial in enumerate(trials)
    ]
    found: dict[str, Mapping[str, float]] = {}
    watched: list[Watched] = []

    def ours() -> None:
        watched.append(Watched(plant, data))
        estimates = fit(watched[-1], NAMES, {}, LOSS_SCALE).estimates
        found["ours"] = {name: e.value for name, e in estimates.items()}

    def theirs() -> None:
        found["theirs"] = sysid.fit(plant, data, NAMES)

    taken = in_turns({"ours": ours, "theirs": theirs}, size.slow_repeats)
    error = _worst(found["theirs"])
    near = np.array([one.near_for_good(error) for one in watched[1:]])  # without the warm-up
    return {
        "identify_speedup_over_mujoco_sysid": ratio(taken, "theirs", "ours"),
        "identify_speedup_at_equal_error": float(np.median(taken["theirs"] / near)),
        "identify_error": _worst(found["ours"]),
        "mujoco_sysid_error": error,
        "identify_seconds": float(np.median(taken["ours"])),
        "mujoco_sysid_seconds": float(np.median(taken["theirs"])),
    }


def _worst(values: Mapping[str, float]) -> float:
    return max(abs(values[name] / TRUTH[name] - 1.0) for name in NAMES)
