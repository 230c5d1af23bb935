"""The arm hangs before a trial where its springs, its weight and its own bend leave it."""

import numpy as np
import pytest

from spirob.control import CURRENT, Schedule
from spirob.effects import find_effects
from spirob.plant import Plant, Rig
from spirob.plant.body import hinge_weights
from spirob.robot import Scene

RIG = Rig()


@pytest.fixture(scope="module")
def plant():
    return Plant(RIG, find_effects(["rest_curvature", "mount_tilt", "stiffness_hardening"]))


def angles(session):
    return np.array(session._data.qpos)


def idle(session, cycles=300):
    nothing = np.zeros((cycles, 2))
    return session.play(Schedule(np.full(2, CURRENT), nothing, nothing, np.full(2, 5.0)))


def test_a_straight_arm_is_not_touched(plant):
    session = plant.start(Scene())
    assert not angles(session).any()
    assert not any(session.state.tobytes())


def test_a_bend_of_its_own_is_the_pose(plant):
    session = plant.start(Scene(), {"rest_curvature.rest_angle": 0.1})
    assert angles(session) == pytest.approx(np.full(RIG.units, 0.1), rel=2e-3)


@pytest.mark.parametrize("name", ["mount_tilt.roll", "arm.gravity_y"])
def test_a_small_weight_bends_each_hinge_by_its_moment_over_its_stiffness(plant, name):
    pull = 1e-3  # m/s²
    value = pull if name == "arm.gravity_y" else np.arcsin(pull / 9.80665)
    session = plant.start(Scene(), {name: float(value)})
    weight = np.zeros((RIG.units, 2))
    hinge_weights(np.zeros(RIG.units), session.arm.units, weight)
    expected = weight[:, 1] * pull / 9.80665 / session.arm.stiffness
    assert angles(session) == pytest.approx(expected, rel=5e-3, abs=1e-8)


@pytest.mark.parametrize(
    "changes",
    [
        {"rest_curvature.rest_angle": -0.15},
        {"mount_tilt.roll": 0.1, "mount_tilt.pitch": -0.05},
        {"arm.gravity_y": 1.0, "stiffness_hardening.hardening": 1.0},
    ],
)
def test_nothing_moves_and_no_length_is_wound_in_before_anything_pulls(plant, changes):
    session = plant.start(Scene(), changes)
    before = angles(session)
    played = idle(session)
    assert np.abs(played.angles - before).max() < 1e-3 * np.abs(before).max()
    assert np.abs(played.displacement).max() < 1e-6
    assert played.tension.max() < 1e-2
    # what the guides see is already taken up: the left tendon is shorter, the right one longer
    assert played.shortening[0] == pytest.approx(played.shortening[-1], rel=1e-3)
    assert np.prod(np.sign(played.shortening[0])) == -1


def test_left_and_right_are_mirror_images(plant):
    left, right = (
        plant.start(Scene(), {"rest_curvature.rest_angle": 0.1 * side}) for side in (1, -1)
    )
    assert angles(left) == pytest.approx(-angles(right), abs=1e-9)
    assert left.state.displacement == pytest.approx(right.state.displacement[::-1], abs=1e-9)
