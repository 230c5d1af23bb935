"""What the campaign tells of composed laws, and what it compares them with."""

import numpy as np
import pytest

from spirob.campaign import true_law
from spirob.campaign.case import Case, cases, drawn
from spirob.campaign.running import _lacking
from spirob.campaign.scoring import group, law_lines, laws, over_true
from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.recording import prepare


def result(law, true=0.01, said=0.05, inside=False, **more):
    truth = {"hidden": ["tight_spot"], "inside": inside, "can_be_shown": True}
    heldout = {"bare": 0.1, "said": said, "law": law, "true": true}
    return {"truth": truth, "heldout": heldout, "composed": None if law is None else {}} | more


def test_a_right_effect_that_is_no_candidate_is_a_group_of_its_own():
    assert group(result(None, inside=True, without=True)) == "taken out"
    assert group(result(None, inside=True, without=False)) == "one"
    assert group(result(None)) == "outside"


def test_the_error_counts_over_that_of_the_true_law_with_or_without_a_law():
    assert over_true(result(0.012)) == pytest.approx(1.2)
    assert over_true(result(None)) == pytest.approx(5.0)
    assert over_true(result(0.012, true=None)) is None
    found = laws([result(0.012), result(0.018), result(None), {"heldout": None}])["outside"]
    assert (found["n"], found["composed"]["n"]) == (3, 3)
    assert [found["within"][most]["value"] for most in ("1.3", "2.0")] == pytest.approx(
        [1 / 3, 2 / 3]
    )
    assert len(law_lines({"outside": found})) == 2


def test_cases_without_the_right_effect_are_played_beside_the_others():
    found = cases(["bench"], ["cogging", "tight_spot", "none"], [1], without=True)
    again = [case.name for case in found if case.without]
    assert again == ["bench-cogging-1-without"]
    assert len(found) == 4
    truth = {"must": [["cogging"]], "besides": ["a"], "near": ["b"]}
    assert _lacking(truth) == ["a", "b", "cogging"]


def test_a_disturbed_machine_is_the_same_one_with_a_force_that_wanders():
    plain, rough = (cases(["bench"], ["cogging"], [1], disturbed=d)[0] for d in (False, True))
    assert (plain.name, rough.name) == ("bench-cogging-1", "bench-cogging-1-disturbed")
    quiet, loud = drawn(plain).about, drawn(rough).about
    assert 0.05 <= loud["slow"] <= 0.3
    assert {**quiet, "slow": loud["slow"]} == loud


@pytest.mark.parametrize("kind", ["tight_spot", "position_viscosity", "hysteretic_spring"])
def test_the_true_law_leaves_little_more_than_noise(kind, tmp_path):
    made = drawn(Case("bench", kind, 7701))
    rig = RigFile.model_validate(made.rig)
    effort = prepare("test", made.test, rig).pieces[0].effort
    left = true_law.least(made, tmp_path) / float(np.sqrt(np.mean(effort**2)))
    noise = np.hypot(made.about["white"], made.about["slow"])
    assert left < 2.0 * noise + 0.01
    assert left < 0.2 * made.truth["share"]
