"""Rates of a trial: closed forms, and what counts as what."""

import pytest

from spirob.campaign.arm.rates import both, is_right, nothing_to_name, rate, rates


def result(kind="rotor_friction", named=("coulomb_friction",), verdict="named", **more):
    plain = {
        "kind": kind,
        "seed": 1,
        "without": False,
        "verdict": verdict,
        "named": list(named) if verdict == "named" else [],
        "probability": 0.95,
        "first": list(named),
        "heldout": {"base": 0.04, "named": 0.02, "oracle": 0.02},
    }
    return plain | more


NULL = {"base": 0.01, "named": 0.01, "oracle": 0.01}


def test_the_interval_is_wilsons():
    """8 of 10: Wilson's 95 % interval is 0.490 to 0.943 (Agresti, Coull 1998)."""
    found = rate([True] * 8 + [False] * 2)
    assert found["value"] == 0.8
    assert found["low"] == pytest.approx(0.490, abs=5e-4)
    assert found["high"] == pytest.approx(0.943, abs=5e-4)


def test_no_cases_say_nothing():
    found = rate([])
    assert (found["low"], found["high"], found["n"]) == (0.0, 1.0, 0)


def test_a_right_name_counts_and_a_wrong_one_does_not():
    assert is_right(result())
    assert not is_right(result(named=("cogging",)))
    assert not is_right(result(verdict="undecided"))


def test_the_rates_of_four_robots():
    found = rates(
        [
            result(),
            result(named=("cogging",)),
            result(verdict="unknown"),
            result("none", verdict="nothing_missing", heldout=NULL),
            result("none", named=("creep",), heldout=NULL),
        ]
    )
    assert found["top1"]["value"] == pytest.approx(1 / 3)
    assert found["wrong_and_confident"]["value"] == pytest.approx(1 / 3)
    assert found["called_unknown"]["value"] == pytest.approx(1 / 3)
    assert found["false_alarm"]["value"] == 0.5
    assert found["confusion"]["none"] == {"nothing_missing": 1, "creep": 1}


def test_where_the_oracle_gains_nothing_there_is_nothing_to_name():
    weak = {"base": 0.0100, "named": 0.0100, "oracle": 0.0099}
    assert nothing_to_name(result(heldout=weak))
    assert not nothing_to_name(result())


def test_both_of_two_need_a_name_each():
    kind = "guide_friction+current_lag"
    assert both(result(kind, named=("current_lag", "capstan_friction")))
    assert not both(result(kind, named=("current_lag",)))
    assert not both(result(kind, named=("current_lag", "feedback_latency")))


def test_a_library_without_the_answer_must_say_so_and_not_be_sure():
    sure = result(named=("cogging",), without=True)
    unsure = result(named=("cogging",), without=True, probability=0.6)
    blind = [result(verdict=v, without=True) for v in ("unknown", "undecided", "nothing_missing")]
    found = rates([sure, unsure, *blind])
    assert found["left_out"]["value"] == pytest.approx(4 / 5)
    assert found["unknown"]["value"] == pytest.approx(2 / 5)
    assert found["top1"]["n"] == 0


def test_the_share_of_the_oracles_gain():
    half = {"base": 0.04, "named": 0.03, "oracle": 0.02}
    found = rates([result(), result(heldout=half)])["excess_error_closed"]
    assert found["value"] == pytest.approx(0.75)


def test_an_effect_that_hardly_shows_is_outside_but_may_still_be_named_wrongly():
    weak = {"base": 0.01, "named": 0.01, "oracle": 0.0095}
    found = rates(
        [
            result(),
            result(verdict="nothing_missing", heldout=weak),
            result(named=("cogging",), heldout=weak),
        ]
    )
    assert (found["top1"]["value"], found["top1"]["n"]) == (1.0, 1)
    assert found["outside"]["value"] == pytest.approx(2 / 3)
    assert found["wrong_and_confident"]["value"] == pytest.approx(1 / 3)


def test_the_oracle_knows_what_an_accepted_name_knew():
    """It adds the first of the accepted names; another may fit the robot's richer effect better."""
    other = {"base": 0.010, "named": 0.003, "oracle": 0.0095}
    found = rates([result("current_offset", ("constant_force",), heldout=other)])
    assert (found["top1"]["value"], found["outside"]["value"]) == (1.0, 0.0)
    assert found["excess_error_closed"]["value"] == 1.0


def test_a_law_counts_over_what_knowing_leaves_where_the_library_lacks_it():
    def blind(law, oracle=0.01):
        error = {"base": 0.04, "named": 0.04, "oracle": oracle}
        composed = None if law is None else {"terms": ["share"], "heldout": law}
        return result(verdict="unknown", without=True, composed=composed, heldout=error)

    seen = [
        blind(0.012),
        blind(0.018),
        blind(None),
        blind(0.012, oracle=0.039),
    ]  # one tells nothing
    found = rates([result(), *seen])
    values = [found[f"law_{name}"]["value"] for name in ("composed", "within_1.3", "within_2.0")]
    assert values == pytest.approx([2 / 3, 1 / 3, 2 / 3])
    assert found["law_composed"]["n"] == 3
    earlier = result(verdict="unknown", without=True)  # by a program that composed no laws
    assert rates([earlier])["law_composed"]["n"] == 0
