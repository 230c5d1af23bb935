"""What the switches of a rig's page say is what the models leave, and the page says it."""

import numpy as np
import pytest
import yaml

from spirob.machine.diagnosis import diagnose
from spirob.report import build_rig_page
from spirob.report.sections.switches import RigSwitches
from spirob.report.sections.verdict import kind
from tests.machine.rigs import description
from tests.machine.test_diagnosis import log


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("switches")
    logs = [log(folder, f"{k}.csv", k) for k in range(3)]
    path = folder / "rig.yaml"
    path.write_text(yaml.safe_dump(description()))
    return diagnose(path, logs[:2], logs[2:])


def by_set(found):
    return {frozenset(one["effects"]): one for one in found.document["switches"]}


def test_every_combination_of_the_candidates_is_there_once(found):
    made = by_set(found)
    names = frozenset().union(*made)
    assert len(made) == len(found.document["switches"]) == 2 ** len(names)
    assert {e["name"] for e in found.document["effects"]} <= names


def test_none_and_the_named_ones_leave_what_the_ladder_says(found):
    made, ladder = by_set(found), found.document["ladder"]
    named = frozenset(e["name"] for e in found.document["effects"])
    assert made[named]["how"] == "verdict"
    for effects, rung in ((frozenset(), ladder[0]), (named, ladder[len(named)])):
        for role in ("train", "test"):
            assert made[effects]["rmse"][role] == pytest.approx(rung[role]["rmse"], rel=1e-6)


def test_errors_of_a_kind_of_regimes_add_up_to_the_whole(found):
    """Forward, backward and standing take the logs apart, so their squares lie about the whole."""
    one = by_set(found)[frozenset()]
    ways = [one["regimes"][name] for name in ("forward", "backward", "standing")]
    assert min(ways) <= np.hypot(*one["rmse"].values()) / np.sqrt(2) * 1.05
    assert max(ways) >= np.hypot(*one["rmse"].values()) / np.sqrt(2) * 0.95


def test_more_effects_leave_no_more_on_the_logs_that_are_fitted(found):
    made = by_set(found)
    for effects, one in made.items():
        for name in effects:
            fewer = made[effects - {name}]["rmse"]["train"]
            assert one["rmse"]["train"] <= 1.01 * fewer


def test_the_page_has_the_switches_and_how_sure(found):
    page = build_rig_page(found)
    assert f'data-unit="{found.document["unit"]}"' in page
    sure = found.document["effects"][0]["probability"]
    assert f"{100 * sure:.0f} % sure" in kind(found.document)
    assert kind(found.document) in page
    assert "Not on this page" in page


def test_a_diagnosis_without_any_has_a_line_at_the_end():
    assert RigSwitches.absent({"switches": []}).endswith(".")
