"""What a number may be depends on the machine that it is a number of."""

import pytest

from spirob.effects import find_effects
from spirob.parameter import Parameter
from spirob.plant import Plant, Rig

WAVE = Parameter(1.0, 0.01, 100.0, "1", "N", "periods in a turn", log=True, geared=True)


@pytest.mark.parametrize(("gear", "low"), [(1.0, 0.9), (18.0, 0.05), (1000.0, 0.01)])
def test_nothing_comes_round_less_often_than_the_drum(gear, low):
    assert WAVE.behind(gear).low == pytest.approx(low)


def test_other_bounds_do_not_know_of_the_gear():
    plain = Parameter(1.0, 0.01, 100.0, "1", "a", "anything")
    assert plain.behind(20.0) == plain


def test_a_machine_s_own_gear_bounds_the_orders_of_its_waves():
    rig = Rig()
    about = Plant(rig, find_effects(["cogging", "torque_ripple"])).table.about
    assert about["cogging.order"].low == pytest.approx(0.9 / rig.winch.gear_ratio)
    assert about["torque_ripple.order"].low == 0.9  # the motor itself, whatever hangs on it


def test_a_number_far_above_a_tiny_lower_bound_has_not_ended_there():
    about = Parameter(1.0, 0.01, 50.0, "kg", "J", "inertia")
    assert not about.at_bound(0.053, 1.0)
    assert about.at_bound(0.01, 1.0)
    assert about.at_bound(50.0, 1.0)
    assert not about.at_bound(49.0, 1.0)
