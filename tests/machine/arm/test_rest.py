"""Currents under which the arm rests as a log begins are fitted, log by log, to the whole log."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.diagnosis.criteria import Settings
from spirob.diagnosis.simulated import ROLES
from spirob.identify.residual import Residual
from spirob.logs.readers import Table
from spirob.machine.arm.preparation import ROUNDS, settled
from spirob.machine.arm.replay import arm_trial
from spirob.machine.arm.rest import is_unsure, rested
from spirob.plant import Plant
from tests.identify.known import moves
from tests.machine.arm.elsewhere import played, rig

NAMES = ["winch.efficiency", "motor.rotor_damping", "arm.base_stiffness"]
TRUE = {"winch.efficiency": 0.7, "motor.rotor_damping": 1.3e-4, "arm.bends_per_hinge": 2.0}
OFF = 4e-3  # A
WAIT = 1.5  # s, in which the arm comes to rest between both tendons
SLIGHT = 0.08  # A


def begun_under_tension(motor, k):
    """A bend of this motor, logged from when the arm rests between both tendons."""
    bend = moves(motor, [[WAIT + 0.2, 0.0], [0.9, 0.04], [0.9, 0.02]], 0.15)
    columns = played({"name": motor, "role": "train", **bend, "duration": 4.0}, TRUE, k=k)
    late = columns["ms"] > columns["ms"][0] + 1e3 * WAIT
    return arm_trial(Table(motor, {n: x[late] for n, x in columns.items()}), rig(), "train")[0]


def asked_to_change_at_once(motor, k):
    """The same, where the other motor pulls harder from the log's second sample on."""
    plain = moves(motor, [[WAIT + 0.2, 0.0], [0.9, 0.04], [0.9, 0.02]], 0.0)
    other = "right" if motor == "left" else "left"
    steps = {"kind": "steps", "plateaus": [[WAIT, SLIGHT], [9.0, 0.2]], "blend": 0.0}
    plain["motors"][other]["profile"] = steps
    trial = {"name": motor, "role": "train", **plain, "duration": 4.0}
    columns = played(trial, TRUE, k=k, every=1)
    late = np.arange(len(columns["ms"])) >= 1e3 * WAIT
    return arm_trial(Table(motor, {n: x[late] for n, x in columns.items()}), rig(), "train")[0]


def moved(trial, by):
    """With what holds the arm off by this, and known to 4 mA."""
    schedule = replace(trial.schedule, held=trial.schedule.held + by)
    return replace(trial, schedule=schedule, unsure=np.full(2, OFF))


@pytest.fixture(scope="module")
def tense():
    logs = [begun_under_tension(motor, k) for k, motor in enumerate(("left", "right"))]
    return Residual(Plant(rig().machine()), logs)


def wrong(tense, by):
    return replace(tense, trials=[moved(t, [by, -by]) for t in tense.trials])


def bias(of, changes=TRUE):
    """Of the current of each log, the mean of what the model misses [A]."""
    missed = of(changes)
    parts = [slice(a, b) for a, b in zip(of.edges[:-1], of.edges[1:], strict=True)]
    return [float(np.mean(missed[p][of.rows[p]])) for p in parts]


def test_what_holds_the_arm_as_a_log_begins_is_told_by_the_whole_log(tense):
    off = wrong(tense, OFF)
    assert min(map(abs, bias(off))) > 0.5 * OFF
    found = off
    for _ in range(ROUNDS):
        found = rested(found, TRUE, off)
    assert max(map(abs, bias(found))) < 0.15 * OFF
    for own, far in zip(found.trials, off.trials, strict=True):
        assert np.all(np.abs(own.schedule.held - far.schedule.held) < 2.0 * OFF)


@pytest.mark.parametrize("motor", ["left", "right"])
def test_a_log_that_begins_with_a_step_begins_before_it(motor):
    trial = asked_to_change_at_once(motor, 0)
    other = 1 if motor == "left" else 0
    current = trial.current[:, other]
    assert abs(current[0] - SLIGHT) < 0.02
    assert abs(np.mean(current[2:12]) - 0.2) < 0.02
    read = Residual(Plant(rig().machine()), [trial])
    found = read
    for _ in range(ROUNDS):
        found = rested(found, TRUE, read)
    assert found.trials[0].schedule.held == pytest.approx([SLIGHT, SLIGHT], abs=5e-3)
    assert abs(bias(found)[0]) < 1e-3


def test_a_log_that_misses_much_moves_it_little(tense):
    """As one does of an arm that lacks an effect."""
    swing = 0.06 * np.sin(2 * np.pi * 1e-3 * np.arange(5000))[:, None]
    off = wrong(tense, OFF)
    swung = replace(
        off, trials=[replace(t, current=t.current + swing[: len(t.current)]) for t in off.trials]
    )
    for own, far in zip(rested(swung, TRUE, swung).trials, off.trials, strict=True):
        assert np.max(np.abs(own.schedule.held - far.schedule.held)) < 0.25 * OFF


def test_logs_that_begin_slack_stay_as_they_are(tense):
    slack = replace(tense, trials=[replace(t, unsure=None) for t in tense.trials])
    assert is_unsure(tense)
    assert rested(slack, TRUE, slack) is slack


def test_the_numbers_of_an_arm_do_not_hang_on_its_first_samples(tense):
    """Nor does it miss more than its noise."""
    off = wrong(tense, OFF)
    residuals = {r: replace(off, trials=[replace(t, role=r) for t in off.trials]) for r in ROLES}
    found = settled(residuals, NAMES, TRUE, [], Settings(), print)
    stiffness = tense.table.about["arm.base_stiffness"].nominal
    assert found.numbers["arm.base_stiffness"] == pytest.approx(stiffness, rel=0.01)
    for of in found.residuals.values():
        assert max(map(abs, bias(of, found.numbers))) < 0.15 * OFF
