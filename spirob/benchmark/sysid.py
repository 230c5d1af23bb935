"""The same fit, stated for `mujoco.sysid` (extra `sysid` of the mujoco wheel)."""

from collections.abc import Sequence
from contextlib import redirect_stdout
from importlib import import_module
from io import StringIO
from typing import Any

import mujoco
import numpy as np

from spirob.errors import ConfigError
from spirob.identify.measurement import Measurement
from spirob.plant import Plant
from spirob.plant.body import build_spec
from spirob.plant.plant import CYCLE
from spirob.robot import MOTORS, Scene


def fit(plant: Plant, trials: Sequence[Measurement], names: Sequence[str]) -> dict[str, float]:
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
