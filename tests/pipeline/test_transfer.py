"""Which fitted numbers stood in for an effect that was not in the model."""

import pytest

from pipeline.transfer import stood_in
from spirob.plant import Plant, Rig


@pytest.fixture(scope="module")
def table():
    return Plant(Rig()).table


def test_what_the_effect_moved_most_comes_first(table):
    identified = {"arm.base_stiffness": 0.36, "winch.efficiency": 0.77, "arm.damping_time": 0.02}
    named = {"arm.base_stiffness": 0.15, "winch.efficiency": 0.79, "arm.damping_time": 0.03}
    found = stood_in(identified, named, table)
    assert [one["name"] for one in found] == ["arm.base_stiffness", "arm.damping_time"]
    assert (found[0]["identified"], found[0]["named"]) == (0.36, 0.15)
    assert found[0]["unit"] == table.about["arm.base_stiffness"].unit


def test_three_at_most_and_none_that_may_be_zero_or_is_in_one_model_alone(table):
    identified = {n: 1.0 for n in table.names if n.startswith("arm.")}
    assert len(identified) > 3
    assert len(stood_in(identified, dict.fromkeys(identified, 2.0), table)) == 3
    both = {"winch.efficiency_difference": -0.1}, {"winch.efficiency_difference": 0.1}
    assert stood_in(*both, table) == []
    assert stood_in({"winch.efficiency": 0.7}, {"arm.damping_time": 0.02}, table) == []
