"""Which fitted numbers stood in for an effect that was not in the model."""

import pytest

from pipeline.transfer import stood_in
from spirob.plant import Plant, Rig


@pytest.fixture(scope="module")
def table():
    return Plant(Rig()).table


def fitted(values, at_bound=()):
    return {n: {"value": v, "at_bound": n in at_bound} for n, v in values.items()}


def test_what_the_effect_moved_most_comes_first(table):
    identified = {"arm.base_stiffness": 0.36, "winch.efficiency": 0.77, "arm.damping_time": 0.02}
    named = {"arm.base_stiffness": 0.15, "winch.efficiency": 0.79, "arm.damping_time": 0.03}
    found = stood_in(fitted(identified), named, table)
    assert [one["name"] for one in found] == ["arm.base_stiffness", "arm.damping_time"]
    assert (found[0]["identified"], found[0]["named"]) == (0.36, 0.15)
    assert found[0]["unit"] == table.about["arm.base_stiffness"].unit


def test_what_was_left_at_nominal_stands_for_nothing(table):
    named = {"arm.base_stiffness": 0.15, "arm.damping_time": 0.03, "arm.bends_per_hinge": 1.9}
    found = stood_in(fitted({"arm.base_stiffness": 0.36}), named, table)
    assert [one["name"] for one in found] == ["arm.base_stiffness"]


def test_a_number_that_its_bound_held_says_so(table):
    values = {"winch.efficiency": 0.8855, "arm.base_stiffness": 0.36}
    named = {"winch.efficiency": 0.70, "arm.base_stiffness": 0.15}
    found = stood_in(fitted(values, at_bound=["winch.efficiency"]), named, table)
    assert {one["name"]: one["at_bound"] for one in found} == {
        "arm.base_stiffness": False,
        "winch.efficiency": True,
    }


def test_three_at_most_and_none_that_may_be_zero_or_is_in_one_model_alone(table):
    identified = fitted({n: 1.0 for n in table.names if n.startswith("arm.")})
    assert len(identified) > 3
    assert len(stood_in(identified, dict.fromkeys(identified, 2.0), table)) == 3
    difference = "winch.efficiency_difference"
    assert stood_in(fitted({difference: -0.1}), {difference: 0.1}, table) == []
    assert stood_in(fitted({"winch.efficiency": 0.7}), {"arm.damping_time": 0.02}, table) == []
