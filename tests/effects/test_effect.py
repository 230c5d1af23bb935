"""Signed numbers of two motors differ; levels, and what is not a motor's, do not."""

import numpy as np
import pytest

from spirob.effects import all_effects, find_effects
from spirob.effects.effect import SUFFIX, differences
from spirob.ports import PORTS
from tests.identify.known import spirob


@pytest.mark.parametrize("effect", all_effects().values(), ids=all_effects())
def test_only_signed_amplitudes_of_motors_have_a_difference(effect):
    found = differences(effect)
    if PORTS[effect.port].each != "motor":
        assert found == {}
    for field in effect.neutral:
        about, neutral = effect.parameters()[field], effect.neutral[field]
        signed = about.low < neutral < about.high and PORTS[effect.port].each == "motor"
        assert (field + SUFFIX in found) == signed


@pytest.mark.parametrize("effect", all_effects().values(), ids=all_effects())
def test_a_difference_stays_within_the_bounds_of_its_number(effect):
    for name, about in differences(effect).items():
        whole = effect.parameters()[name.removesuffix(SUFFIX)]
        neutral = effect.neutral[name.removesuffix(SUFFIX)]
        assert about.nominal == 0.0
        assert whole.low <= neutral + about.low
        assert neutral + about.high <= whole.high


def test_half_left_minus_right_is_added_left_and_taken_off_right():
    """A sensor's offset only on the left is mean and half difference of one size."""
    plant = spirob(find_effects(["current_offset"]))
    assert "current_offset.offset_difference" in plant.table.names
    trial = plant_trial()
    both = {"current_offset.offset": 0.02, "current_offset.offset_difference": 0.02}
    plain = plant.simulate(*trial).current
    left = plant.simulate(*trial, both).current
    first = (left - plain)[0]
    assert first == pytest.approx([0.04, 0.0])


def test_without_a_difference_nothing_changes():
    plant = spirob(find_effects(["current_offset"]))
    trial = plant_trial()
    one = plant.simulate(*trial, {"current_offset.offset": 0.02})
    same = {"current_offset.offset": 0.02, "current_offset.offset_difference": 0.0}
    assert np.array_equal(one.current, plant.simulate(*trial, same).current)


def plant_trial():
    """Half a second of the first bend."""
    from spirob.campaign.arm.bends import bends
    from spirob.trials import Trial

    trial = Trial.from_plain(bends()[0])
    return trial.schedule(500), trial.scene
