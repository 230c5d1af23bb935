"""A log of the arm is played again by the model; what cannot be is refused in a sentence."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.control import CURRENT, DISPLACEMENT
from spirob.diagnosis.criteria import noise_floor
from spirob.effects import find_effects
from spirob.errors import ConfigError, DataError, MissingChannel
from spirob.identify.fit import fit
from spirob.identify.problem import effort_rms
from spirob.identify.residual import Residual
from spirob.logs.readers import Table
from spirob.machine.arm.replay import arm_trial
from spirob.plant import Plant
from tests.identify import known as identify
from tests.identify.known import moves
from tests.machine.arm.elsewhere import description, log, played, rig

TRUE = {"winch.efficiency": 0.7, "motor.rotor_damping": 2e-4}


@pytest.fixture(scope="module")
def columns():
    return log("train", 0, TRUE)


def test_the_models_own_log_is_repeated_by_its_own_numbers_only(columns):
    trial, _ = arm_trial(Table("log", columns), rig(), "train")
    residual = Residual(Plant(rig().machine()), [trial])
    right, wrong = residual(TRUE), residual({**TRUE, "winch.efficiency": 0.5})
    size = effort_rms(residual)
    assert np.sqrt(np.mean(right[residual.rows] ** 2)) < 0.005 * size
    assert np.sqrt(np.mean(wrong[residual.rows] ** 2)) > 0.1 * size


def test_the_same_numbers_are_found_as_where_its_commands_are_known():
    """A fit to the trials as they were commanded, one to the same signals as somebody's CSV."""
    names = ["winch.efficiency", "motor.rotor_damping", "motor.rotor_inertia"]
    known = identify.residual(Plant(rig().machine()), TRUE)
    logs = [
        arm_trial(Table("log", log("train", k, TRUE, every=1)), rig(), "train")[0] for k in (0, 1)
    ]
    found = [fit(r, names, {}, 0.05) for r in (known, Residual(known.plant, logs))]
    for name in names:
        a, b = (f.estimates[name] for f in found)
        assert a.value == pytest.approx(b.value, rel=0.01)
        assert max(a.low, b.low) < min(a.high, b.high)


def test_a_commanded_current_is_given_where_the_log_holds_it(columns):
    given = {**columns, "asked": 1e3 * np.arange(len(columns["ms"]))}
    right = {**description()["right"], "command": {"column": "asked", "unit": "mA"}}
    trial, _ = arm_trial(Table("log", given), rig(right=right), "train")
    np.testing.assert_allclose(trial.schedule.reference[::2, 1], np.arange(len(columns["ms"]))[:-1])
    with pytest.raises(ValueError, match=r"command\.unit 'm' is no current"):
        rig(right={**right, "command": {"column": "asked", "unit": "m"}})


def test_a_drive_reports_the_cycle_that_ends(columns):
    """So what a motor is given in a cycle is in the next row."""
    trial, _ = arm_trial(Table("log", columns), rig(), "train")
    np.testing.assert_array_equal(trial.schedule.reference[:-1, 1], trial.current[1:, 1])


@pytest.mark.parametrize(
    "name",
    [
        "coulomb_friction",
        "cogging",
        "torque_constant_saturation",
        "direction_dependent_efficiency",
        "load_dependent_friction",
        "eccentric_winch",
        "capstan_friction",
        "gear_compliance",
        "constant_force",
        "current_offset",
        "encoder_eccentricity",
    ],
)
def test_an_effect_takes_its_own_error_away(name):
    """Of each port that shows in such a log: with the effect nothing but the noise is left."""
    (effect,) = find_effects([name])
    true = TRUE | {f"{name}.{f}": about.nominal for f, about in effect.parameters().items()}
    trial, _ = arm_trial(Table("log", log("train", 0, true, [effect], every=1)), rig(), "train")
    trial = replace(trial, first_angle=(0.0, 0.0))  # as the model began
    residual = Residual(Plant(rig().machine(), [effect]), [trial])
    with_it, without = (np.std(residual(x)[residual.rows]) for x in (true, TRUE))
    assert with_it < 1.2 * noise_floor(residual)
    assert with_it < 0.5 * without


def test_a_log_may_begin_under_tension():
    """The arm rests under the first currents: a log cut from the middle of a pull, at a hold."""
    pull = moves("left", [[0.3, 0.0], [1.5, 0.02], [1.6, 0.02], [1.6, 0.05]], 0.3)
    whole = played({"name": "pull", "role": "train", **pull, "duration": 5.0}, TRUE)
    late = {name: values[1600:] for name, values in whole.items()}
    trial, _ = arm_trial(Table("log", late), rig(), "train")
    assert trial.schedule.held == pytest.approx(trial.current[:50].mean(axis=0), abs=0.01)
    assert abs(trial.displacement[0, 0]) < 1e-5
    residual = Residual(Plant(rig().machine()), [trial])
    straight = Residual(
        residual.plant, [replace(trial, schedule=replace(trial.schedule, held=None))]
    )
    missed, without = (np.std(r(TRUE)[r.rows]) for r in (residual, straight))
    assert missed < 0.02 * effort_rms(residual)
    assert without > 3.0 * missed


def test_the_motor_that_does_the_work_is_found_and_said(columns):
    trial, said = arm_trial(Table("log", columns), rig(), "train")
    assert list(trial.schedule.mode) == [DISPLACEMENT, CURRENT]
    assert any("the left motor does the work" in text for text in said)
    assert trial.displacement[:, 0].max() == pytest.approx(0.05, rel=0.05)


def test_a_log_that_begins_in_motion_is_refused(columns):
    late = {name: values[500:] for name, values in columns.items()}
    with pytest.raises(DataError, match="log: it begins in motion"):
        arm_trial(Table("log", late), rig(), "train")


def test_gaps_missing_columns_and_unknown_parts_are_named(columns):
    torn = {name: np.delete(values, slice(800, 1000)) for name, values in columns.items()}
    with pytest.raises(DataError, match=r"log: 1 gap, .* from its beginning to its end"):
        arm_trial(Table("log", torn), rig(), "train")
    less = {name: values for name, values in columns.items() if name != "right current"}
    with pytest.raises(MissingChannel, match="'right current'"):
        arm_trial(Table("log", less), rig(), "train")
    with pytest.raises(ConfigError, match="rig has no part 'wheel'"):
        rig(arm={"wheel": {}}).machine()


def test_the_cutoff_is_that_of_the_motion_to_follow(columns):
    """A shake of 60 Hz passes a filter of 120 Hz and not one of 20 Hz."""
    seconds = 1e-3 * (columns["ms"] - columns["ms"][0])
    shake = 5.0 * (seconds > 1.0) * np.sin(2 * np.pi * 60.0 * (seconds - 1.0))  # deg
    shaken = {**columns, "left angle": columns["left angle"] + shake}
    left = {}
    for cutoff in (20.0, 120.0):
        arm = rig(filter={"cutoff": cutoff})
        moved, still = (arm_trial(Table("log", c), arm, "train")[0] for c in (shaken, columns))
        left[cutoff] = np.std((moved.schedule.reference - still.schedule.reference)[1300:-300, 0])
    assert left[20.0] < 0.05 * left[120.0]


def test_a_cutoff_out_of_range_is_refused():
    with pytest.raises(ValueError, match=r"filter\.cutoff"):
        rig(filter={"cutoff": 1.0})
