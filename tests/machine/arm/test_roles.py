"""Logs are given roles; a single one is divided into blocks, each of which is scored by itself."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from spirob.diagnosis.criteria import Settings
from spirob.effects import all_effects
from spirob.errors import DataError, TooShort
from spirob.identify.residual import Residual
from spirob.logs.readers import Table
from spirob.machine.arm import diagnosis
from spirob.machine.arm.diagnosis import overlay
from spirob.machine.arm.replay import arm_trial
from spirob.machine.arm.rows import Part, block, roles
from spirob.plant import Plant
from tests.machine.arm.elsewhere import long_log, rig, tables

FRICTION = all_effects()["coulomb_friction"]
TRUE = {"winch.efficiency": 0.7, "coulomb_friction.coulomb_torque": 0.004}
HALVES = (Part("log", 0.0, 0.5), Part("log", 0.5, 1.0))


@pytest.fixture(scope="module")
def trial():
    return arm_trial(Table("log", long_log({})), rig(), "train")[0]


@pytest.fixture(scope="module")
def plant():
    return Plant(rig().machine())


def shares(parts):
    return {
        role: [(p.log, round(p.begin, 9), round(p.end, 9)) for p in of]
        for role, of in parts.items()
    }


def test_whole_logs_where_there_are_enough():
    found, said = roles(["a", "b", "c", "d"], ["e"])
    assert {role: [part.log for part in of] for role, of in found.items()} == {
        "train": ["a", "b", "c"],
        "validate": ["d"],
        "heldout": ["e"],
    }
    assert all(part.whole for of in found.values() for part in of)
    assert said == []


@pytest.mark.parametrize(
    ("train", "test", "blocks"),
    [
        (
            "a",
            "",
            {"train": [("a", 0, 0.5)], "validate": [("a", 0.5, 0.7)], "heldout": [("a", 0.7, 1)]},
        ),
        (
            "a",
            "b",
            {"train": [("a", 0, 0.8)], "validate": [("a", 0.8, 1)], "heldout": [("b", 0, 1)]},
        ),
        (
            "ab",
            "",
            {
                "train": [("a", 0, 0.7)],
                "validate": [("b", 0, 0.7)],
                "heldout": [("a", 0.7, 1), ("b", 0.7, 1)],
            },
        ),
    ],
)
def test_too_few_logs_are_divided_and_it_is_said(train, test, blocks):
    found, said = roles(list(train), list(test))
    assert shares(found) == blocks
    assert "Blocks of one trial share its start, load and temperature." in said


def test_blocks_together_are_the_whole(trial, plant):
    """Cut behind the filter, the blocks' residuals are the rows of the whole log's."""
    whole = Residual(plant, [trial])
    begin = 5000
    used = np.arange(len(trial.current)) >= begin
    late = Residual(plant, [replace(trial, use=used)])
    early = Residual(plant, [replace(trial, use=np.ones_like(used))])
    changes = {"winch.efficiency": 0.6}
    every = late.filter.every
    assert np.array_equal(early(changes), whole(changes))
    pairs = ((late, whole), (late.measured(), whole.measured()), (late.rows, whole.rows))
    samples = len(trial.seconds[::every])
    for part, all_of_it in pairs:
        a, b = (x(changes) if callable(x) else x for x in (part, all_of_it))
        assert np.array_equal(a, b.reshape(-1, samples)[:, begin // every :].ravel())
    assert late.stretches()[0].seconds[0] == pytest.approx(5.0)
    assert len(late.raw()[0]) == len(trial.current[begin :: trial.every])


def test_a_block_ends_where_it_ends_and_counts_from_where_it_begins(trial):
    half = round(0.5 * len(trial.current))
    early, late = (block(trial, part) for part in HALVES)
    assert len(early.current) == half
    assert early.use is None
    assert len(late.current) == len(trial.current)
    assert np.flatnonzero(late.use)[0] == half
    assert late.use[half:].all()
    assert early.schedule.cycles == half
    assert [one.name for one in (early, late)] == ["log (0 to 50 %)", "log (50 to 100 %)"]
    short = replace(trial, current=trial.current[:3000])
    with pytest.raises(TooShort, match="a log that is to be divided needs at least 4000"):
        block(short, HALVES[0])


def test_a_block_leaves_out_what_its_log_does(trial):
    half = round(0.5 * len(trial.current))
    use = np.arange(len(trial.current)) % 3 > 0
    early, late = (block(replace(trial, use=use), part) for part in HALVES)
    np.testing.assert_array_equal(early.use, use[:half])
    assert not late.use[:half].any()
    np.testing.assert_array_equal(late.use[half:], use[half:])
    use[half + 100 :] = False
    with pytest.raises(
        DataError, match=r"log \(50 to 100 %\): of its part from [\d.]+ to [\d.]+ s less"
    ):
        block(replace(trial, use=use), HALVES[1])


def test_one_log_alone_is_searched_in_blocks(tmp_path):
    """The right effect explains the block that no fit saw; one log may not be enough to name it."""
    pd.DataFrame(long_log(TRUE, [FRICTION])).to_csv(tmp_path / "one.csv", index=False)
    arm = rig(fit=["winch.efficiency"])
    trials, said = diagnosis.read(arm, tables([tmp_path / "one.csv"]), [])
    settings = Settings(finalists=1, most=1, intervals=False)
    found = diagnosis.searched(arm, trials, settings, print, [FRICTION])
    bare, best = found.models.tried[frozenset()], found.models.tried[frozenset({FRICTION.name()})]
    assert best.heldout_square < 0.04 * bare.heldout_square
    document = diagnosis.written(arm, found, said)
    assert any("the last 30% of each training log was kept aside" in t for t in document["repairs"])
    assert any("one.csv (50 to 70 %), which no fit has seen" in t for t in document["repairs"])
    shown = overlay(found)
    times = {role: rows["time"] for role, rows in shown.groupby("role")}
    assert times["test"].min() == pytest.approx(7.0, abs=0.02)
    assert times["train"].max() < 5.0
