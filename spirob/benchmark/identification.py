"""Identification against `mujoco.sysid` (an extra of the mujoco wheel) on the same trials.

Both fit η, b_m and J_m from the same start.  `mujoco.sysid` knows no drive and no elastic tendon:
there the rotor is the tendon's armature J_eq/r² and damping b_eq/r², the measured current is the
input and the measured displacement the output.  Errors are the largest relative error of a fitted
number against the one that the data were made with.

The two do not end at the same error, so two ratios are taken: of the whole fits, ours with its
intervals, which the other does not give; and of the time until ours is for good as near to the
truth as the other ends.
"""

import time
from collections.abc import Mapping, Sequence
from contextlib import redirect_stdout
from importlib import import_module
from io import StringIO
from typing import Any

import mujoco
import numpy as np

from spirob.benchmark.timing import Size, in_turns, moving, ratio
from spirob.errors import ConfigError
from spirob.identify.descent import robust_cost
from spirob.identify.fit import fit
from spirob.identify.measurement import Measurement
from spirob.identify.residual import Residual
from spirob.plant import Plant, Rig
from spirob.plant.body import build_spec
from spirob.plant.plant import CYCLE
from spirob.robot import MOTORS, Scene
from spirob.trials.simulation import simulate


def fit_by_mujoco(
    plant: Plant, trials: Sequence[Measurement], names: Sequence[str]
) -> dict[str, float]:
    """Fit the named numbers of motor and winch; values by name.

    Each moves as a factor on its nominal value, so that all are of one size, within the
    bounds of our own fit.  Raises ConfigError where the extra is not installed.
    """
    sysid: Any = import_module("mujoco.sysid")  # the extra is for this comparison only
    if not hasattr(sysid, "ParameterDict"):  # without the extra the module is there, and empty
        raise ConfigError("the comparison needs mujoco.sysid: pip install 'mujoco[sysid]'")

    spec = _machine(plant)
    model = spec.compile()
    parameters = sysid.ParameterDict()
    for name in names:
        about, nominal = plant.table.about[name], plant.table.values[plant.table.position(name)]
        low, high = (edge / nominal for edge in about.reach(float(nominal)))
        parameters.add(sysid.Parameter(name, nominal=1.0, min_value=low, max_value=high))

    def build(candidate, base):  # type: ignore[no-untyped-def]
        factors = {name: float(candidate[name].value[0]) for name in names}
        return _with_motor(base.copy(), plant, factors).compile()

    count = len(trials)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    straight = data.actuator_length.copy()
    start = sysid.create_initial_state(model, np.zeros(model.nq), np.zeros(model.nv))
    sequences = sysid.ModelSequences(
        "arm",
        _with_motor(spec, plant, {}),
        [trial.name for trial in trials],
        [start] * count,
        [sysid.TimeSeries(trial.seconds, trial.current) for trial in trials],
        [
            sysid.TimeSeries.from_names(trial.seconds, straight + trial.displacement, model)
            for trial in trials
        ],
    )
    residual = sysid.build_residual_fn(models_sequences=[sequences], build_model=build)
    with redirect_stdout(StringIO()):  # it prints every iteration all the same
        best, _ = sysid.optimize(parameters, residual, optimizer="mujoco", verbose=False)
    table = plant.table
    return {n: float(best[n].value[0] * table.values[table.position(n)]) for n in names}


def _machine(plant: Plant) -> mujoco.MjSpec:
    """The arm with its tendons, and their shortening as sensors."""
    rig = plant.rig
    spec = build_spec(rig.arm, Scene(), rig.lengths(), CYCLE / plant.substeps, tendons=True)
    for motor in MOTORS:
        # an actuator's length is gear times the tendon's: -1 there, so it grows with shortening
        spec.add_sensor(
            name=f"{motor}_wound",
            type=mujoco.mjtSensor.mjSENS_ACTUATORPOS,
            objtype=mujoco.mjtObj.mjOBJ_ACTUATOR,
            objname=motor,
        )
    return spec


def _with_motor(spec: mujoco.MjSpec, plant: Plant, factors: dict[str, float]) -> mujoco.MjSpec:
    """Rotor and gear as the tendons' armature and damping and the actuators' gain."""
    rig = plant.rig
    ratio = rig.winch.gear_ratio / rig.winch.radius
    pull = ratio * rig.motor.torque_constant * rig.winch.efficiency
    for motor in MOTORS:
        tendon = spec.tendon(motor)
        tendon.armature = (
            ratio**2 * rig.motor.rotor_inertia * factors.get("motor.rotor_inertia", 1.0)
        )
        damping = ratio**2 * rig.motor.rotor_damping * factors.get("motor.rotor_damping", 1.0)
        tendon.damping = np.array([damping, 0.0, 0.0])
        spec.actuator(motor).gainprm[0] = pull * factors.get("winch.efficiency", 1.0)
    return spec


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
        found["theirs"] = fit_by_mujoco(plant, data, NAMES)

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
