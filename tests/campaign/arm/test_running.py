"""A trial draws its cases, keeps what is done, and diagnoses a robot over the bus."""

import json
from types import SimpleNamespace

import pytest

from spirob.campaign.arm import bends, running, strength
from spirob.campaign.arm.case import Case, quickly, run
from spirob.cli.main import main
from spirob.diagnosis.criteria import Settings
from spirob.errors import DataError
from spirob.identify import builds
from tests.campaign.arm.test_killed import fake

QUICK = quickly(Settings(finalists=1, most=1, iterations=1, patience=1))  # as a trial plays


def test_cases_hold_every_kind_with_every_seed_and_the_nulls():
    chosen = running.cases(["cogging", "current_gain"], [4, 5], nulls=3, without=True)
    names = [case.name for case in chosen]
    assert len(set(names)) == len(names) == 2 * 2 + 3
    assert "cogging-5-without" in names
    assert "none-6" in names


def test_pairs_are_drawn_with_every_seed():
    names = [case.name for case in running.cases(["cogging"], [4, 5], nulls=0, pairs=True)]
    assert len(names) == 2 + 2 * len(running.PAIRS)
    assert "guide_friction_and_current_lag-5" in names


def written(path, *results):
    path.write_text("".join(json.dumps(one) + "\n" for one in results))
    return path


def test_results_that_are_there_are_kept(tmp_path, monkeypatch):
    case = Case("cogging", 7, without=True)
    whole = {
        "kind": "cogging",
        "seed": 7,
        "robot": case.robot,
        "without": False,
        "build": "typical",
    }
    done = [whole, {**whole, "without": True}]
    table = written(tmp_path / "cases.jsonl", *done)
    monkeypatch.setattr(running, "run", lambda *a: pytest.fail("it was run again"))
    assert running.play([case], table, workers=1) == done
    assert running.play([Case("cogging", 7)], table, workers=1) == [whole]


def test_a_case_that_was_not_played_without_its_answer_is_left():
    case = Case("cogging", 7, without=True)
    whole = {
        "kind": "cogging",
        "seed": 7,
        "robot": case.robot,
        "without": False,
        "build": "typical",
    }
    assert running.left([case], [whole]) == [case]


def test_a_line_that_was_cut_off_is_no_result_and_any_other_is_a_sentence(tmp_path):
    whole = {"kind": "none", "seed": 7, "robot": 1, "without": False}
    table = written(tmp_path / "cases.jsonl", whole)
    table.write_text(table.read_text() + '{"kind": "none", "se')
    assert running.known(table) == [whole]
    table.write_text(table.read_text() + "\n" + json.dumps(whole) + "\n")
    with pytest.raises(DataError, match="line 2 is no result of a trial"):
        running.known(table)


def test_what_is_played_again_takes_the_old_result_s_place(tmp_path, monkeypatch):
    case, other = Case("none", 7), Case("none", 8)
    kept = fake(other, None)
    table = written(tmp_path / "cases.jsonl", {**fake(case, None)[0], "robot": 7}, *kept)
    monkeypatch.setattr(running, "run", fake)
    assert running.play([case], table, workers=1) == fake(case, None)
    assert running.known(table) == kept + fake(case, None)


def test_a_result_of_another_robot_is_no_result():
    case = Case("none", 7)
    assert running.left([case], [{"kind": "none", "seed": 7, "robot": 7, "without": False}])


def test_a_result_of_another_strength_is_no_result():
    strong, weak = Case("cogging", 7), Case("cogging", 7, ratios=(0.5, 0.9))
    found = [
        {"kind": "cogging", "seed": 7, "robot": strong.robot, "without": False, "build": "typical"}
    ]
    assert running.left([strong], found) == []
    assert running.left([weak], found) == [weak]
    assert strong.robot == weak.robot


def test_a_result_of_another_build_is_no_result():
    plain, rough = (running.cases(["cogging"], [7], 1, build=b) for b in ("as_designed", "rough"))
    assert {case.build for case in rough} == {"rough"}
    assert [case.robot for case in rough] == [case.robot for case in plain]
    assert not {case.name for case in rough} & {case.name for case in plain}
    found = [{**fake(case, None)[0], "kind": case.kind} for case in plain]
    assert running.left(plain, found) == []
    assert running.left(rough, found) == rough


def test_each_kind_has_a_robot_of_its_own_and_without_the_right_name_the_same():
    cases = [Case(kind, seed) for kind in ("none", "cogging", "creep+cogging") for seed in (4, 5)]
    assert len({case.robot for case in cases}) == len(cases)
    assert Case("cogging", 4, without=True).robot == Case("cogging", 4).robot


@pytest.mark.parametrize(
    "flag",
    [
        ["--kinds", "gremlins"],
        ["--seeds", "5:5"],
        ["--seeds", "x"],
        ["--ratios", "0.5:0.3"],
        ["--ratios", "half"],
        ["--build", "perfect"],
        ["--out", "."],
    ],
)
def test_bad_choices_are_a_sentence(flag, capsys, tmp_path):
    assert main(["trial", "--out", str(tmp_path / "cases.jsonl"), *flag]) == 2
    assert flag[1] in capsys.readouterr().err


def test_a_strong_lag_of_the_sensor_is_found_on_a_robot_of_its_own(monkeypatch):
    """The whole way: drawn, recorded over the bus, decoded, diagnosed, compared with the oracle.

    What is told of a robot is left out that has tests of its own: what it leaves with nothing
    hidden, by which a strength is drawn, and the law composed of what has no name.  Half of
    the builds say how large the floor is, and half of the bends are played.
    """
    monkeypatch.setattr(builds, "DRAWS", 9)
    few = ("train_deep", "train_fast", "validate_right", "heldout_left")
    monkeypatch.setattr(bends, "BENDS", [b for b in bends.BENDS if b[0] in few])
    law = SimpleNamespace(document={"terms": ["way"], "rmse": {"test": 0.1}})
    asked = []
    library = running.run.__globals__["all_effects"]()
    names = ("current_lag", "feedback_latency", "coulomb_friction")
    few = {name: library[name] for name in names}
    monkeypatch.setitem(running.run.__globals__, "all_effects", lambda: few)
    monkeypatch.setattr(strength, "strength_of", lambda kind, size: 0.2)
    monkeypatch.setitem(running.run.__globals__, "composed_for_arm", lambda *of: law)
    monkeypatch.setattr(strength, "TRIES", 1)
    monkeypatch.setattr(strength, "nothing", lambda *of: asked.append(of) or strength.LEFT)
    found, without = run(Case("current_lag", 77, without=True), QUICK)
    assert found["named"] == ["current_lag"]
    assert found["heldout"]["oracle"] < 0.5 * found["heldout"]["base"]
    assert found["heldout"]["named"] < 0.5 * found["heldout"]["base"]
    assert asked == [(Case("current_lag", 77).robot, "typical")]
    assert without["named"] == []
    assert without["composed"]["terms"] == ["way"]
    assert found["composed"] is None
    json.dumps([found, without])
