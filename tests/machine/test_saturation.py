"""A command is what the drive got; a measured effort ends at one value in all logs of a rig."""

import numpy as np
import pandas as pd
import pytest

from spirob.logs.readers.columns import from_frame
from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.recording import of_table, prepare
from spirob.machine.recordings.saturation import ends_of_logs
from tests.machine.rigs import description
from tests.machine.test_checks import good

EFFORT = {"column": "u", "unit": "N·m", "kind": "torque"}
MEASURED = RigFile.model_validate(description(effort=EFFORT))
COMMANDED = RigFile.model_validate(description(effort={**EFFORT, "origin": "command"}))


def left_out(made):
    return any("where the drive saturates" in said for said in made.said)


@pytest.mark.parametrize("limit", [0.39, 0.3, 0.1])
def test_a_command_does_not_saturate_at_what_was_commanded(limit):
    log = good()
    clipped = {**log, "u": np.clip(log["u"], -limit, limit)}
    made = prepare("log", clipped, COMMANDED)
    assert made.said == []
    whole = prepare("log", log, COMMANDED)
    assert made.pieces[0].use.sum() == whole.pieces[0].use.sum()


def test_a_command_saturates_where_its_limit_is():
    limited = RigFile.model_validate(
        description(effort={**EFFORT, "origin": "command", "limit": 0.3})
    )
    assert left_out(prepare("log", good(), limited))


def test_an_effort_of_one_sign_rests_at_zero():
    log = good()
    pulled = {**log, "u": np.maximum(log["u"] + 0.1, 0.0)}
    assert 0.3 < np.mean(pulled["u"] == 0.0) < 0.5
    assert not left_out(prepare("log", pulled, MEASURED))
    clipped = {**log, "u": np.clip(log["u"] + 0.1, 0.0, 0.45)}
    piece = prepare("log", clipped, MEASURED).pieces[0]
    assert piece.raw[piece.use].max() < 0.45
    assert piece.raw[piece.use].min() == 0.0


@pytest.mark.parametrize("supply", [{}, {"kind": "duty", "unit": "1", "supply": 12.0}])
def test_a_measured_effort_saturates_at_the_ends_of_all_logs(supply):
    """A log of smaller efforts that stays at its own largest does not: another one exceeds it."""
    rig = RigFile.model_validate(description(effort={**EFFORT, **supply}))
    log = good()
    small = {**log, "u": np.clip(0.5 * log["u"], -0.15, 0.15)}
    large = {**log, "u": np.clip(log["u"], -0.3, 0.3)}
    tables = [from_frame(pd.DataFrame(log), name) for name, log in (("s", small), ("l", large))]
    ends = ends_of_logs(rig, tables)
    assert [left_out(of_table(table, rig, None, ends)) for table in tables] == [False, True]
    assert [left_out(of_table(table, rig)) for table in tables] == [True, True]


def test_what_a_controller_is_computed_to_ask_for_is_a_command():
    effort = {"from": "control", "kind": "torque", "unit": "N·m"}
    control = {"kp": 0.5, "limit": 0.3}
    rig = RigFile.model_validate(
        description(effort=effort, control=control, reference={"column": "w", "unit": "rad"})
    )
    log = good()
    made = prepare("log", {"t": log["t"], "q": log["q"], "w": log["q"] + log["u"] * 2.0}, rig)
    assert np.mean(np.abs(made.pieces[0].raw) == 0.3) > 0.1
    assert not left_out(made)


def test_all_logs_decide_whether_ends_are_steps():
    """One that is a relay for the most part is no other drive than one that is for a part."""
    log = good()
    relay = {**log, "u": np.where(log["u"] > 0, 0.3, -0.3)}
    mixed = {**log, "u": np.where(log["t"] < 1.2, relay["u"], 0.5 * log["u"])}
    tables = [from_frame(pd.DataFrame(log), name) for name, log in (("r", relay), ("m", mixed))]
    made = [of_table(table, MEASURED, None, ends_of_logs(MEASURED, tables)) for table in tables]
    assert [left_out(one) for one in made] == [False, False]
    assert all(any("steps of the command" in said for said in one.said) for one in made)


def test_means_over_equal_efforts_stay_at_the_end_of_the_logs():
    log = good(rate=5000)
    clipped = {**log, "u": np.clip(log["u"], -0.3, 0.3)}
    table = from_frame(pd.DataFrame(clipped), "fast")
    made = of_table(table, MEASURED, None, ends_of_logs(MEASURED, [table]))
    assert any("means of 5 samples" in said for said in made.said)
    assert left_out(made)
