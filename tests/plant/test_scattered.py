"""An arm whose hinges differ from the law of stiffness, each by its own factor."""

import numpy as np
import pytest

from spirob.plant import Plant
from spirob.plant.tendon import shortenings
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


def test_holes_where_they_belong_give_the_same_bits():
    plant = Plant(GEARED)
    none = plant.scattered(np.ones(24), np.zeros((2, 25, 2)))
    np.testing.assert_array_equal(played(none).angles, played(plant).angles)


def test_mirrored_holes_bend_a_mirrored_arm_the_other_way():
    """Both tendons pull alike, and only where their holes differ does the arm bend."""
    off = np.random.default_rng(3).uniform(-3e-4, 3e-4, (2, 25, 2))
    plant, both = Plant(GEARED), currents(np.full(400, 0.3), 0.3)
    one, other = (
        plant.scattered(np.ones(24), holes).simulate(both, Scene()).angles
        for holes in (off, off[::-1])
    )
    assert np.abs(one).max() > 1e-3
    np.testing.assert_allclose(one, -other, atol=1e-9)


def test_a_hole_farther_out_winds_in_more_for_the_same_bend():
    off = np.zeros((2, 25, 2))
    off[0, :, 1] = 1e-3
    plant = Plant(GEARED)
    session, drawn = plant.scattered(np.ones(24), off).start(Scene()), plant.start(Scene())
    pose = np.full(24, 0.1)
    left, right = (shortenings(pose, *s._guides) for s in (session, drawn))
    assert left[0] > 1.01 * right[0]
    assert left[1] == pytest.approx(right[1])
