"""A log of the arm is played again by the model; what cannot be is refused in a sentence."""

import numpy as np
import pytest

from spirob.errors import ConfigError, DataError, MissingChannel
from spirob.identify.problem import effort_rms
from spirob.identify.residual import Residual
from spirob.logs.readers import Table
from spirob.machine.arm.replay import arm_trial
from spirob.plant import Plant
from tests.machine.arm.elsewhere import log, rig

TRUE = {"winch.efficiency": 0.7, "motor.rotor_damping": 2e-4}


@pytest.fixture(scope="module")
def columns():
    return log("train", 0, TRUE)


def test_the_models_own_log_is_repeated_by_its_own_numbers_only(columns):
    trial, _ = arm_trial(Table("log", columns), rig(), "train")
    residual = Residual(Plant(rig().machine()), [trial])
    right, wrong = residual(TRUE), residual({**TRUE, "winch.efficiency": 0.5})
    size = effort_rms(residual)
    assert np.sqrt(np.mean(right[residual.rows] ** 2)) < 0.02 * size
    assert np.sqrt(np.mean(wrong[residual.rows] ** 2)) > 0.1 * size


def test_the_motor_that_does_the_work_is_found_and_said(columns):
    trial, said = arm_trial(Table("log", columns), rig(), "train")
    assert list(trial.schedule.mode) == [2, 0]
    assert any("the left motor does the work" in text for text in said)
    assert trial.displacement[:, 0].max() == pytest.approx(0.05, rel=0.05)


def test_a_log_that_begins_in_motion_is_refused(columns):
    late = {name: values[500:] for name, values in columns.items()}
    with pytest.raises(DataError, match="log: it begins in motion"):
        arm_trial(Table("log", late), rig(), "train")


def test_gaps_missing_columns_and_unknown_parts_are_named(columns):
    torn = {name: np.delete(values, slice(800, 1000)) for name, values in columns.items()}
    with pytest.raises(DataError, match=r"log: 1 gaps, .* from its beginning to its end"):
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
