"""Rows of an arm's log that are not compared; all of it is played."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from spirob.cli.main import main
from spirob.diagnosis.atlas import survey
from spirob.diagnosis.criteria import Settings
from spirob.diagnosis.orders import answers
from spirob.effects import all_effects
from spirob.errors import ConfigError, DataError
from spirob.identify.residual import STILL, Near, Residual, near
from spirob.logs.readers import Table
from spirob.machine.arm import diagnosis
from spirob.machine.arm.replay import arm_trial
from spirob.machine.arm.rows import holds
from spirob.machine.loading import load_rig
from spirob.plant import Plant
from tests.machine.arm.elsewhere import description, log, rig, write

TRUE = {"winch.efficiency": 0.7}
COGGING = all_effects()["cogging"]
LIMIT = 600.0  # mA


@pytest.fixture(scope="module")
def columns():
    return log("train", 0, TRUE)


def limited(limit=LIMIT, **changes):
    """A description with a limit of the left motor's drive."""
    left = description()["left"]
    left["effort"]["limit"] = limit
    return rig(left=left, **changes)


def clipped(columns):
    """The log of a drive that reports no current above the limit."""
    return {**columns, "left current": np.minimum(columns["left current"], LIMIT)}


def trial_of(columns, arm):
    return arm_trial(Table("log", columns), arm, "train")


def test_without_the_keys_all_of_a_log_is_compared(columns):
    trial, said = trial_of(columns, rig())
    assert trial.use is None
    assert not any("left out" in text for text in said)


def test_where_a_drive_saturates_is_left_out_and_said(columns):
    trial, said = trial_of(clipped(columns), limited())
    full = trial.current[:, 0] >= LIMIT / 1e3 - 1e-6
    assert 0.05 < full.mean() < 0.5
    assert not trial.use[full].any()
    assert trial.use.mean() > 0.4
    assert any(
        "of the rows left out, where the drive of the left motor saturates" in text for text in said
    )
    assert trial_of(columns, limited(limit=9e3))[0].use is None


def fitted(columns, arm):
    """The efficiency of this log."""
    trials = {role: [trial_of(columns, arm)[0]] for role in ("train", "validate", "heldout")}
    quick = Settings(most=0, intervals=False)
    found = diagnosis.searched(arm, trials, quick, print, [])
    return found.stands.fit.estimates["winch.efficiency"].value


def test_a_saturated_stretch_no_longer_bends_the_fit(columns):
    bounds = {"winch.efficiency": {"nominal": 0.8, "low": 0.6, "high": 1.0}}
    right = fitted(columns, rig(fit=bounds))
    bent = fitted(clipped(columns), rig(fit=bounds))
    mended = fitted(clipped(columns), limited(fit=bounds))
    assert right == pytest.approx(0.7, rel=0.01)
    assert abs(bent - 0.7) > 0.05
    assert mended == pytest.approx(0.7, rel=0.02)


def test_rows_are_chosen_by_the_speed_of_the_working_motor(columns):
    """In its own unit, degrees of the rotor a second."""
    speed = np.abs(trial_of(columns, rig())[0].velocity[:, 0]) * 180 / np.pi
    speed *= rig().machine().winch.gear_ratio / rig().machine().winch.radius
    slow, _ = trial_of(columns, rig(rows={"minimum_speed": 500.0}))
    fast, said = trial_of(columns, rig(rows={"maximum_speed": 500.0}))
    np.testing.assert_array_equal(slow.use, speed >= 500.0)
    np.testing.assert_array_equal(fast.use, speed <= 500.0)
    assert any("as too fast" in text for text in said)


def test_holds_are_dropped_where_it_is_asked_for(columns):
    trial, said = trial_of(columns, rig(rows={"standstill": "drop"}))
    assert any("where the working motor stands" in text for text in said)
    assert not trial.use[:150].any()
    assert trial.use[np.abs(trial.velocity[:, 0]) > STILL].all()  # slower ones are reversals, too
    assert trial.use[200:].all()


def test_both_ends_are_dropped_and_every_nth_cycle_is_kept(columns):
    arm = rig(filter={"decimate": 16, "drop": 250})
    trials = {role: [trial_of(columns, arm)[0]] for role in ("train", "validate", "heldout")}
    found = diagnosis.searched(arm, trials, Settings(most=0), print, [])
    (stretch,) = found.models.train.stretches()
    assert stretch.seconds[0] == pytest.approx(0.256)
    assert np.diff(stretch.seconds) == pytest.approx(0.016)
    assert stretch.seconds[-1] < 1e-3 * (len(trials["train"][0].current) - 250)
    assert found.models.train.block == 31


def test_what_is_compared_is_a_part_of_the_whole_residual(columns):
    """Signals are filtered before rows are left out, and each row in all of its signals."""
    trial, _ = trial_of(clipped(columns), limited())
    plant, changes = Plant(rig().machine()), {"winch.efficiency": 0.8}
    part = Residual(plant, [trial])
    whole = Residual(plant, [trial_of(clipped(columns), rig())[0]])
    kept = trial.use[:: whole.filter.every]
    for one, all_of_it in ((part(changes), whole(changes)), (part.rows, whole.rows)):
        np.testing.assert_array_equal(one, all_of_it.reshape(3, -1)[:, kept].ravel())
    assert len(part.raw()[0]) == np.count_nonzero(trial.use[:: trial.every])


def test_screening_and_atlas_follow_what_is_compared(columns):
    plant = Plant(rig().machine(), [COGGING])
    missing = {}
    for name, arm in (("whole", rig()), ("part", limited())):
        problem = Residual(plant, [trial_of(clipped(columns), arm)[0]])
        missed = problem({})
        (found,) = answers(problem, SimpleNamespace(changes={}, residual=missed), COGGING)
        seen = problem({"cogging.order": 1.0, "cogging.sine": 2e-4}) - missed
        told = 2e-4 * found.columns(np.array([1.0]))[0][:, [0, 2]].sum(axis=1)
        missing[name] = np.mean((told - seen) ** 2) / np.mean(seen**2)
    assert missing["part"] == pytest.approx(missing["whole"], abs=0.1)
    cheap = near(problem, TRUE)
    assert isinstance(cheap, Near)
    np.testing.assert_allclose(cheap(TRUE), problem(TRUE), atol=1e-9)
    assert survey(problem, {}, missed[problem.rows])["atlas"]


def test_a_log_of_which_nothing_is_left_is_refused(columns):
    with pytest.raises(DataError, match=r"log: only 0 s are left .* \(100\.0% .* as too slow\)"):
        trial_of(columns, rig(rows={"minimum_speed": 1e6}))


def test_a_motor_that_is_held_at_its_limit_leaves_nothing_and_is_named(columns):
    right = description()["right"]
    right["effort"]["limit"] = 250.0  # mA, what it is held at
    with pytest.raises(DataError, match="the drive of the right motor saturates"):
        trial_of(columns, rig(right=right))


SLOW = {"effort": {"column": "left current", "unit": "mA", "limit": -1.0}}


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"filter": {"decimate": 17}}, "filter: decimate: 17 cycles .* 30 Hz; 16 at most"),
        ({"filter": {"decimate": 0}}, r"filter\.decimate: "),
        ({"filter": {"drop": -1}}, r"filter\.drop: "),
        ({"rows": {"standstill": "yes"}}, r"rows\.standstill: Input should be 'drop' or 'keep'"),
        ({"rows": {"load": 1.0}}, r"rows\.load: no such key"),
        ({"left": {**description()["left"], **SLOW}}, r"left\.effort\.limit: .* greater than 0"),
        ({"gear": 50.0}, r"gear: has no place with body: arm; it is winch\.gear_ratio"),
        ({"rest_speed": 0.1}, "rest_speed: has no place with body: arm"),
    ],
)
def test_a_mistake_is_a_sentence_with_its_place(tmp_path, changes, sentence):
    with pytest.raises(ConfigError, match=sentence):
        load_rig(write(tmp_path, **changes))


@pytest.mark.parametrize("changes", [{"gear": 50.0}, {"rows": {"minimum_speed": 1e6}}])
def test_a_mistake_ends_the_command_with_a_sentence(tmp_path, columns, changes, capsys):
    path = write(tmp_path, **changes)
    pd.DataFrame(columns).to_csv(tmp_path / "log.csv", index=False)
    order = ["--train", str(tmp_path / "log.csv"), "--out", str(tmp_path / "out")]
    assert main(["diagnose", "--rig", str(path), *order]) == 2
    (said,) = capsys.readouterr().err.strip().splitlines()
    assert said.startswith("spirob: ")


def test_a_tenth_of_a_second_of_standing_is_a_hold_and_a_reversal_is_none():
    t = np.arange(0.0, 2.0, 1e-3)
    assert not holds(np.sin(np.pi * t)).any()
    stops = np.where((t > 0.5) & (t < 0.8), 0.0, 0.1)
    held = t[holds(stops)]
    assert 0.5 < held.min() < 0.56
    assert 0.74 < held.max() < 0.8
    assert not holds(np.where((t > 0.5) & (t < 0.55), 0.0, 0.1)).any()
