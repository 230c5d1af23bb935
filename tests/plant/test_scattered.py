"""An arm whose hinges differ from the law of stiffness, each by its own factor."""

import numpy as np

from spirob.plant import Plant
from spirob.robot import Scene
from tests.physics.playing import GEARED, currents

PULLED = currents(np.linspace(0.0, 0.5, 800), 0.2)


def played(plant, changes=None):
    return plant.simulate(PULLED, Scene(), changes)


def test_factors_of_one_give_the_same_bits():
    plant = Plant(GEARED)
    np.testing.assert_array_equal(played(plant.scattered(np.ones(24))).angles, played(plant).angles)


def test_one_factor_for_all_is_another_stiffness():
    plant = Plant(GEARED)
    twice = played(plant, {"arm.base_stiffness": 0.3})
    np.testing.assert_allclose(
        played(plant.scattered(np.full(24, 2.0))).angles, twice.angles, atol=1e-9
    )
