"""Logs that do not belong together, or go one way, are seen before a name is believed."""

import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import spirob
from spirob.machine.axis import diagnose_recordings
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import Sizes
from spirob.machine.recordings.recording import prepare
from spirob.machine.search import odd_logs
from spirob.machine.search.odd_logs import (
    EFFORTS_APART,
    FAMILIAR,
    UNITS_APART,
    _mended,
    another_unit,
    one_way,
    poorest,
    way_of,
)
from tests.machine.rigs import description


def strangers(*about):
    """What is said of logs that the others' model does not fit."""
    odd = odd_logs.strangers(*about)
    return odd.said if odd else ""


def odd_one_out(*about):
    """What is said of the log without which all others fit."""
    odd = odd_logs.odd_one_out(*about)
    return odd.said if odd else ""


SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")


def problem(*factors):
    """Logs of one axis, whose effort is so many times the true one."""
    rig, logs = RigFile.model_validate(description()), []
    for k, factor in enumerate(factors):
        t = np.arange(0, 6, 2e-3)
        w = 4.0 + k
        effort = 0.01 * -(w**2) * np.sin(w * t) + 0.3 * w * np.cos(w * t)
        made = {"t": t, "q": np.sin(w * t), "u": factor * effort}
        logs.append(prepare(f"log{k}", made, rig))
    return InverseProblem(rig, None, logs, [], SIZES, 0.02)


@pytest.mark.parametrize(("signs", "strange"), [((1, 1, 1), ""), ((1, -1, 1), "log1")])
def test_a_log_of_another_motor_is_named(signs, strange):
    made = problem(*signs)
    said = strangers([made], [made({"rig.inertia": 0.01, "rig.viscous": 0.3})])
    assert said.partition(":")[0] == strange


def half_turned(t):
    """A sign that turns in the middle of a log."""
    return np.where(t < 3.0, 1.0, -1.0)


@pytest.mark.parametrize(
    ("factors", "odd"),
    [
        ((1, 3, 1), "log1: .*; as 3 times the model, 100% of the variance is explained"),
        ((1, 1, -1), "log2: .*; with its effort's .*sign turned 100% of the variance"),
        ((half_turned(np.arange(0, 6, 2e-3)), 1, 1), "log0: [^;]*$"),
        ((1, 1, 1), None),
        ((1, 3), None),
        ((1, 3, 9), None),
    ],
)
def test_the_log_without_which_all_others_fit_is_named(factors, odd):
    made = problem(*factors)
    nothing = odd_one_out([made], [-0.9 * made.measured()])
    assert re.match(odd, nothing) if odd else nothing == ""
    fits_all = odd_one_out([made], [0.1 * made.measured()])
    assert fits_all == (nothing if "turned" in nothing else "")


def rubbing(*units, efforts=(1.0, 1.0, 1.0)):
    """Logs of an axis that is hardly more than dry friction, each position in a unit of its own."""
    rig = RigFile.model_validate(description())
    logs = [prepare(f"log{k}", log, rig) for k, log in enumerate(rubbed(units, efforts))]
    return InverseProblem(rig, None, logs, [], SIZES, 0.02)


def rubbed(units, efforts):
    """The columns of such logs."""
    for k, unit in enumerate(units):
        t = np.arange(0, 6, 2e-3)
        q = np.sin((4.0 + k) * t) + 0.3 * np.sin(9.0 * t)
        v = np.gradient(q, t)
        effort = 0.01 * np.gradient(v, t) + 0.1 * v + 0.5 * np.tanh(v / 0.02)
        yield {"t": t, "q": unit * q, "u": efforts[k] * effort}


@pytest.mark.parametrize("left", [0.9, 0.1])  # of the effort, by a model that may fit all of them
@pytest.mark.parametrize("unit", UNITS_APART)
def test_the_log_whose_position_has_another_unit_is_named_with_it(unit, left):
    made = rubbing(1.0, unit, 1.0)
    said = odd_one_out([made], [-left * made.measured()])
    assert re.match(rf"log1: .* position times {1 / unit:.4g} (99|100)% of the variance", said)


@pytest.mark.parametrize("left", [0.9, 0.1])
@pytest.mark.parametrize("unit", EFFORTS_APART)
def test_the_log_whose_effort_has_another_unit_is_named_with_it(unit, left):
    made = rubbing(1.0, 1.0, 1.0, efforts=(1.0, unit, 1.0))
    said = odd_one_out([made], [-left * made.measured()])
    assert re.match(rf"log1: .* effort times {1 / unit:.4g} (99|100)% of the variance", said)


def lifting(turned="u", sign=1.0, weight=0.5, zero=0.0):
    """Three logs of a lever with a weight; in the second a column is turned, or its zero moved."""
    rig, logs = RigFile.model_validate(description()), []
    for k in range(3):
        t = np.arange(0, 6, 2e-3)
        q = np.sin((4.0 + k) * t) + 0.3 * np.sin(9.0 * t)
        v = np.gradient(q, t)
        friction = 0.1 * v + 0.2 * np.tanh(v / 0.02)
        effort = 0.01 * np.gradient(v, t) + friction + weight * np.sin(q + zero * (k == 1))
        made = {"t": t, "q": q, "u": effort}
        made[turned] = made[turned] * (sign if k == 1 else 1.0)
        logs.append(prepare(f"log{k}", made, rig))
    return InverseProblem(rig, None, logs, [], SIZES, 0.02)


@pytest.mark.parametrize(("column", "name"), [("u", "effort"), ("q", "position")])
def test_a_log_turned_round_is_told_before_a_payload_is_fitted_to_it(column, name):
    said = another_unit([lifting(column, -1.0)])
    assert re.match(rf"log1: .* explain 0% .*; with .*{name}'s .*sign turned (9\d|100)%", said)


@pytest.mark.parametrize("zero", [0.0, 1.0, np.pi])
def test_a_lever_that_was_mounted_otherwise_has_no_sign_turned(zero):
    for weight in (0.5, 5.0):
        assert another_unit([lifting(weight=weight, zero=zero)]) == ""


def test_where_a_log_has_another_unit_no_law_is_looked_for(tmp_path):
    made = rubbing(1.0, 180 / np.pi, 1.0)
    steps: list[str] = []
    found = diagnose_recordings(
        made.rig, tmp_path, made.recordings[:2], made.recordings[2:], progress=steps.append
    )
    assert found.document["verdict"] == "unknown"
    assert "by another unit" in found.document["explanation"]
    assert found.document["candidates"] == []
    assert not any("screened" in step for step in steps)


def test_of_two_logs_of_different_units_either_may_be_the_one():
    made = rubbing(1.0, 180 / np.pi)
    said = odd_one_out([made], [-0.1 * made.measured()])
    assert said.endswith("as by another unit of one of the two logs.")


def test_a_log_whose_end_is_held_out_is_one_log():
    made, ends = rubbing(1.0, 180 / np.pi, 1.0), rubbing(1.0, 180 / np.pi, 1.0)
    for recording in ends.recordings:
        recording.name += ", its end"
    said = odd_one_out([made, ends], [-0.1 * p.measured() for p in (made, ends)])
    assert said.startswith("log1: ")


def test_logs_that_move_by_other_speeds_are_of_one_unit():
    made = rubbing(1.0, 1.0, 1.0)
    assert odd_one_out([made], [-0.9 * made.measured()]) == ""


def test_what_mends_a_strange_log_is_said_with_its_share():
    modelled = np.sin(np.arange(1000) / 30)
    assert "sign turned 100%" in _mended(-modelled, modelled)
    assert "an offset of 3" in _mended(modelled + 3.0, modelled)
    assert "as 5 times the model" in _mended(5.0 * modelled, modelled)
    assert _mended(np.random.default_rng(0).normal(size=1000), modelled) == ""
    wave = np.cos(np.arange(1000) / 3)
    assert _mended(modelled + 0.5 * wave + 0.2, modelled) == ""  # a quarter of what is missed
    assert "an offset of 1" in _mended(modelled + 0.5 * wave + 1.0, modelled)


def turning(*ways, name="log"):
    """Logs in which an axis turns one way, or to and fro."""
    rig, logs = RigFile.model_validate(description()), []
    for k, way in enumerate(ways):
        t = np.arange(0, 6, 2e-3)
        v = np.sin(4 * t) + 2.0 * way
        made = {"t": t, "q": np.cumsum(v) * 2e-3, "u": 0.3 * v + 0.5 * np.sign(v)}
        logs.append(prepare(f"{name}{k}", made, rig))
    return InverseProblem(rig, None, logs, [], SIZES, 0.02)


@pytest.mark.parametrize(
    ("train", "heldout", "said"),
    [
        ((1, 1), (1,), ("one way only", "")),
        ((-1,), (1,), ("one way only", "held out go back")),
        ((-1, -1), (0,), ("one way only", "held out go back")),
        ((1, -1), (1,), None),
        ((0,), (1,), None),
    ],
)
def test_logs_of_one_direction_are_told(train, heldout, said):
    found = one_way(turning(*train), turning(*heldout))
    assert bool(found) == (said is not None)
    for text in said or ():
        assert text in found[0]


def test_held_out_logs_that_rest_do_not_go_back():
    rig, t = RigFile.model_validate(description()), np.arange(0, 6, 2e-3)
    still = prepare("log", {"t": t, "q": 1e-4 * np.sin(4 * t), "u": np.cos(t)}, rig)
    heldout = InverseProblem(rig, None, [still], [], SIZES, 0.02)
    assert "go back" not in one_way(turning(1), heldout)[0]


@pytest.mark.parametrize(("ways", "familiar"), [((1, 1), True), ((-1, -1), True), ((1, 0), False)])
def test_of_logs_of_one_way_a_model_explains_the_level(ways, familiar):
    """Of the second log it has the level, and nothing of what changes."""
    made = turning(*ways)
    first, second = np.split(made.measured(), made.edges[1:-1])
    residual = np.r_[0.1 * (first - first.mean()), 1.1 * (second.mean() - second)]
    assert (strangers([made], [residual]) == "") == familiar
    assert (poorest([made], [residual]) > FAMILIAR) == familiar


def test_the_end_of_a_log_at_one_effort_is_judged_with_its_beginning():
    """About its own mean nothing of a hold is explained, though the log is the others' machine."""
    rig, t = RigFile.model_validate(description()), np.arange(0, 6, 2e-3)
    v = np.where(t < 3.0, 4.0 * np.cos(4 * t), 2.0 + 0.01 * np.sin(4 * t))
    halves = [
        prepare(name, {"t": t[rows], "q": np.cumsum(v)[rows] * 2e-3, "u": 0.3 * v[rows]}, rig)
        for name, rows in (("log", slice(0, 1500)), ("log (end)", slice(1500, None)))
    ]
    for ends in (True, False):
        parts = [replace(half, log="log") if ends else half for half in halves]
        kept, held = (InverseProblem(rig, None, [r], [], SIZES, 0.02) for r in parts)
        residuals = [0.1 * kept.measured(), 0.6 * held.measured()]
        said = strangers([kept, held], residuals)
        assert said.partition(":")[0] == ("" if ends else "log (end)")


def test_a_rare_row_the_other_way_and_rest_are_no_direction():
    speeds = np.r_[np.full(1000, 2.0), np.full(5, -2.0), np.full(5000, 0.01)]
    assert way_of(speeds, 0.02) == 1
    assert way_of(-speeds, 0.02) == -1
    assert way_of(np.r_[speeds, np.full(20, -2.0)], 0.02) == 0
    assert way_of(np.full(10, 0.01), 0.02) == 0


def test_a_strange_log_that_alone_goes_its_way_is_told_so():
    fitted, back = turning(1, 1), turning(-1, name="back")
    residuals = [0.1 * fitted.measured(), -3.0 * back.measured()]
    assert "a way that no other log does" in strangers([fitted, back], residuals)
    mixed = turning(1, 0)
    assert "a way" not in strangers([mixed, back], [0.1 * mixed.measured(), residuals[1]])


def stepping(*levels, scale=1.0, more=0.0):
    """Ramps of effort both ways, and then steps to these efforts; the last is so many times more.

    The axis turns as fast as its friction lets it.
    """
    rig, logs = RigFile.model_validate(description()), []
    for k, level in enumerate((-1.0, 1.0, *levels)):
        t = np.arange(0, 8, 2e-3)
        u = 6.0 * level * t / 8.0 if k < 2 else level * (1.0 - np.exp(-20.0 * t)) ** 40
        v = (u - 0.4 * np.sign(u)) / 0.5 + 0.1 * np.sin(5.0 * t)
        last = k == len(levels) + 1
        made = {"t": t, "q": np.cumsum(v) * 2e-3, "u": (scale * u + more) if last else u}
        logs.append(prepare(f"log{k}", made, rig))
    return InverseProblem(rig, None, logs, [], SIZES, 0.02)


BY_ITS_FRICTION = {"rig.inertia": 0.0, "rig.viscous": 0.55}


@pytest.mark.parametrize("levels", [(7.0, -7.0), (7.0, 7.0), (7.0, 7.0, 7.0, 7.0)])
def test_a_step_at_one_effort_that_the_model_foretells_is_no_other_machine(levels):
    made = stepping(*levels)
    residuals = [made(BY_ITS_FRICTION)]
    measured = made.measured()[made.edges[-2] :]
    assert np.sqrt(np.mean(residuals[0][made.edges[-2] :] ** 2)) < 0.15 * np.abs(measured).max()
    assert strangers([made], residuals) == ""
    assert odd_one_out([made], residuals) == ""


@pytest.mark.parametrize(
    "wrong", [{"scale": -1.0}, {"scale": 3.0}, {"scale": 0.3}, {"more": 7.0}, {"more": -4.0}]
)
def test_a_step_that_the_model_does_not_foretell_is_named(wrong):
    made = stepping(7.0, -7.0, 7.0, **wrong)
    assert strangers([made], [made(BY_ITS_FRICTION)]).startswith("log4: ")


def starting(speed, rate=25.0):
    """A log of a screw that starts, goes there, stops and goes back, five times: dry friction."""
    t = np.arange(0, 30, 1 / rate)
    v = speed * np.sign(np.sin(2 * np.pi * t / 3.0)) * (np.abs(np.sin(2 * np.pi * t / 3.0)) > 0.4)
    q = np.concatenate([[0.0], np.cumsum(v[:-1])]) / rate
    return {"t": t, "q": q, "u": 2.8e-3 * np.sign(v) + 3e-5 * v}


def test_two_logs_of_steady_speeds_against_dry_friction_are_of_one_unit():
    """Its column is filtered as the effort is: a square wave would fit less well than the speed."""
    rig = RigFile.model_validate(description())
    logs = [prepare(f"log{k}", starting(v), rig) for k, v in enumerate((21.0, 5.2))]
    made = InverseProblem(rig, None, logs, [], SIZES, 0.2)
    assert odd_one_out([made], [-0.1 * made.measured()]) == ""


@pytest.mark.parametrize(("level", "strange"), [(1.0, ""), (0.5, "log2")])
def test_a_log_at_nearly_one_effort_is_strange_only_where_its_level_is(level, strange):
    """What little varies in it the model of the others misses whole, in both."""
    rig, t = RigFile.model_validate(description()), np.arange(0, 6, 2e-3)
    logs = []
    for k in range(3):
        v = 2.0 * np.cos((4.0 + k) * t) if k < 2 else 1.0 + 0.2 * np.cos(4.0 * t)
        effort = v if k < 2 else level + 0.05 * np.cos(11.0 * t)
        logs.append(prepare(f"log{k}", {"t": t, "q": np.cumsum(v) * 2e-3, "u": effort}, rig))
    made = InverseProblem(rig, None, logs, [], SIZES, 0.02)
    said = strangers([made], [made({"rig.inertia": 0.0, "rig.viscous": 1.0})])
    assert said.partition(":")[0] == strange
    said = odd_one_out([made], [-0.9 * made.measured()])
    assert said.partition(":")[0] == strange


def test_the_verdict_is_of_the_other_logs_where_one_fits_none():
    """It says which, and why; of two logs either may be the one."""
    turned = half_turned(np.arange(0, 6, 2e-3))
    tables = [pd.DataFrame(log) for log in rubbed([1.0] * 4, [1.0, turned, 1.0, 1.0])]
    rig = description(criteria={"most": 1})  # what else a search may find is not asked here
    found = spirob.diagnose(rig, train=tables[:3], test=tables[3:])
    assert found.sentence.startswith("Without train[1], which fits no other log: ")
    assert found.notes[0].startswith("train[1]: ")
    assert [one.name for one in found.findings] == ["coulomb_friction"]
    assert not spirob.diagnose(rig, train=tables[:2]).sentence.startswith("Without")
