"""Null space and correlation in words: who goes with whom, and why."""

import pytest

from spirob.report.sections.parameters import correlation
from spirob.report.words import null_space, pairs, spoken

NAMES = ["winch.efficiency", "motor.rotor_damping", "motor.rotor_inertia", "arm.base_stiffness"]


def resolution(*weakest, table=None):
    names = NAMES[: len(weakest)]
    plain = [[float(i == k) for k in range(len(names))] for i in range(len(names))]
    return {
        "names": names,
        "correlation": table or plain,
        "weakest": dict(zip(names, weakest, strict=True)),
        "least": 0.00055,
        "most": 0.0207,
        "unit": "A",
    }


def test_all_growing_in_step_is_the_scale_of_force():
    said = null_space(resolution(0.82, 0.33, 0.34, 0.30), 0.0158)
    assert "winch efficiency, rotor damping, rotor inertia and base stiffness growing" in said
    assert "a tenth along it changes the effort by 0.550 mA RMS" in said
    assert "by 20.7 mA; the fit leaves 15.8 mA" in said
    assert "A trial with a known weight fixes it." in said


def test_one_against_another_is_no_scale_of_force():
    said = null_space(resolution(0.71, 0.01, -0.70, 0.02), None)
    assert "winch efficiency growing against rotor inertia:" in said
    assert "known weight" not in said
    assert "leaves" not in said


def test_a_single_number_is_said_to_be_alone():
    assert "rotor damping alone" in null_space(resolution(0.01, 0.99, 0.02, 0.0), 0.1)


@pytest.mark.parametrize(("value", "word"), [(0.97, "ratio"), (-0.97, "product")])
def test_pairs_that_go_together_are_known_by_ratio_or_product(value, word):
    (said,) = pairs(resolution(0.7, 0.7, table=[[1.0, value], [value, 1.0]]))
    assert said.startswith("Winch efficiency and rotor damping")
    assert f"their {word} is known better" in said


def test_loose_pairs_are_not_mentioned():
    assert pairs(resolution(0.7, 0.7, table=[[1.0, 0.5], [0.5, 1.0]])) == []


def test_the_matrix_shows_each_pair_once():
    rows = correlation(resolution(0.7, 0.7, table=[[1.0, -0.25], [-0.25, 1.0]]))
    assert [len(row["cells"]) for row in rows] == [0, 1]
    assert rows[1]["cells"][0] == {"text": "−0.25", "share": 25, "sign": False}


def test_names_are_spoken():
    assert [spoken(n) for n in NAMES[:2]] == ["winch efficiency", "rotor damping"]
    assert spoken("stiffness") == "stiffness"
