"""Bad logs of the arm: a sentence or a stated repair, never a confident name."""

import numpy as np
import pandas as pd
import pytest

from spirob.diagnosis.criteria import Settings
from spirob.diagnosis.verdict import SENSELESS
from spirob.effects import all_effects
from spirob.errors import DataError
from spirob.identify.residual import SENSE, Residual, explained
from spirob.logs.readers import Table
from spirob.machine.arm import diagnosis
from spirob.machine.arm.replay import arm_trial, barely_moves
from spirob.plant import Plant
from tests.machine.arm.elsewhere import exchanged, log, rig, tables

FRICTION = all_effects()["coulomb_friction"]
HIDDEN = {"winch.efficiency": 0.7, "coulomb_friction.coulomb_torque": 0.004}
LOGS = (("train", 0), ("train", 1), ("validate", 0), ("heldout", 0))


@pytest.fixture(scope="module")
def columns():
    return log("train", 0, {})


def changed(columns, name, rows, value):
    values = columns[name].copy()
    values[rows] = value if np.isscalar(value) else value(values)[rows]
    return {**columns, name: values}


def diagnosed(folder, bad):
    """The document of the logs with a hidden friction; those of which `bad` is true exchanged."""
    paths = []
    for role, k in LOGS:
        found = log(role, k, HIDDEN, [FRICTION])
        paths.append(folder / f"{role}_{k}.csv")
        pd.DataFrame(exchanged(found) if bad(role) else found).to_csv(paths[-1], index=False)
    arm = rig(fit=["winch.efficiency", "motor.rotor_damping"])
    settings = Settings(finalists=1, most=1, iterations=1, patience=2, intervals=False)
    trials, said = diagnosis.read(arm, tables(paths[:3]), tables(paths[3:]))
    found = diagnosis.searched(arm, trials, settings, print, [FRICTION])
    return diagnosis.written(arm, found, said)


def test_exchanged_motors_get_no_name_but_a_sentence(tmp_path):
    document = diagnosed(tmp_path, lambda role: True)
    assert document["verdict"] == "unknown"
    assert document["effects"] == []
    assert document["sentence"] == SENSELESS
    assert "are the columns of the two motors exchanged" in document["explanation"]


def test_an_arm_that_moves_next_to_nothing_is_said(columns):
    """As where millimetres are taken for metres; a hundredth of the stroke is enough to say so."""
    slight = {n: v / 1000.0 if "angle" in n else v for n, v in columns.items()}
    for found, said in ((columns, 0), (slight, 1)):
        trial, _ = arm_trial(Table("log", found), rig(), "train")
        told = barely_moves([trial], rig())
        assert len(told) == said
        assert all("is the unit or the factor of a position another?" in text for text in told)


def test_one_exchanged_log_among_good_ones_is_named(tmp_path):
    document = diagnosed(tmp_path, lambda role: role == "heldout")
    assert document["verdict"] == "unknown"
    assert document["effects"] == []
    (said,) = [text for text in document["repairs"] if "exchanged" in text]
    assert said.startswith("heldout_0.csv: ")
    assert "explains 0% of its current's variance" in said


def test_a_few_missing_values_are_bridged_and_said(columns):
    torn = changed(columns, "right current", [300, 301, 700], np.nan)
    trial, said = arm_trial(Table("log", torn), rig(), "train")
    assert np.isfinite(trial.current).all()
    assert "log: 3 missing values of 'right current' were bridged." in said


@pytest.mark.parametrize("name", ["left angle", "right current"])
def test_many_missing_values_are_refused(columns, name):
    torn = changed(columns, name, slice(300, 600), np.nan)
    with pytest.raises(DataError, match=f"log: '{name}' has no number in 300 rows"):
        arm_trial(Table("log", torn), rig(), "train")


@pytest.mark.parametrize("name", ["left angle", "right angle"])
def test_a_constant_position_is_refused(columns, name):
    stuck = changed(columns, name, slice(None), 7.0)
    with pytest.raises(DataError, match=f"log: column '{name}' is constant at"):
        arm_trial(Table("log", stuck), rig(), "train")


def test_a_constant_current_is_said_and_makes_no_sense_where_it_does_the_work(columns):
    still = changed(columns, "right current", slice(None), 250.0)
    _, said = arm_trial(Table("log", still), rig(), "")
    assert "log: 'right current' is constant at 0.25 A, taken as commanded." in said
    stuck = changed(columns, "left current", slice(None), 250.0)
    trial, said = arm_trial(Table("log", stuck), rig(), "train")
    assert "log: 'left current' is constant at 0.25 A, taken as commanded." in said
    residual = Residual(Plant(rig().machine()), [trial])
    assert explained(residual, residual({}))["log"] < SENSE


def test_two_constant_currents_are_refused(columns):
    still = np.zeros_like(columns["ms"])
    stuck = {**columns, "left current": still, "right current": still}
    with pytest.raises(DataError, match="log: 'left current' and 'right current' are constant"):
        arm_trial(Table("log", stuck), rig(), "train")


def test_a_position_that_jumps_is_refused(columns):
    span = np.ptp(columns["left angle"])
    lost = changed(columns, "left angle", slice(900, None), lambda values: values + 0.2 * span)
    with pytest.raises(DataError, match="log: 'left angle' jumps by"):
        arm_trial(Table("log", lost), rig(), "train")


def test_single_spikes_of_a_position_are_bridged_and_said(columns):
    spiked = changed(columns, "left angle", [500, 900], lambda values: values + 4096.0)
    whole, said = arm_trial(Table("log", spiked), rig(), "train")
    clean, _ = arm_trial(Table("log", columns), rig(), "train")
    assert np.abs(whole.displacement - clean.displacement).max() < 1e-4  # m
    assert any("jumps of 'left angle' out and back were bridged" in text for text in said)
