"""A trial is declared as plain data and refuses nonsense by its own name and key."""

import numpy as np
import pytest

from spirob.control import CURRENT, VELOCITY
from spirob.errors import ConfigError
from spirob.robot import Scene
from spirob.trials import Trial
from tests.trials.trials import plain_trial


def test_a_trial_gives_a_schedule_of_its_length():
    trial = Trial.from_plain(plain_trial(0.4))
    schedule = trial.schedule()
    assert schedule.cycles == trial.cycles == 400
    assert schedule.mode.tolist() == [VELOCITY, CURRENT]
    assert schedule.current_limit.tolist() == [5.0, 2.0]
    assert schedule.reference.shape == schedule.reference_rate.shape == (400, 2)
    assert np.array_equal(trial.schedule(100).reference, schedule.reference[:100])


def test_only_displacement_has_a_reference_rate():
    motors = plain_trial()["motors"]
    motors["left"] = {
        "mode": "displacement",
        "profile": {"kind": "sine", "amplitude": 0.02, "frequency": 1.0},
        "current_limit": 5.0,
    }
    schedule = Trial.from_plain(plain_trial(motors=motors)).schedule()
    numeric = np.gradient(schedule.reference[:, 0], 1e-3)
    np.testing.assert_allclose(schedule.reference_rate[1:-1, 0], numeric[1:-1], atol=1e-3)
    assert not schedule.reference_rate[:, 1].any()


def test_no_scene_is_an_empty_table():
    plain = plain_trial()
    del plain["scene"]
    assert Trial.from_plain(plain).scene == Scene()


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"role": "test"}, "role must be train or validate or heldout"),
        ({"duration": 0}, "duration must be a number above 0"),
        ({"duration": True}, "duration must be a number above 0"),
        ({"duration": 1e-5}, "shorter than one cycle"),
        ({"colour": "red"}, "no key 'colour'"),
        ({"motors": {}}, "motors needs 'left'"),
        ({"motors": [1]}, "motors must be a mapping"),
        ({"scene": {"cylinder": {"diameter": 0.04, "x": 0.3}}}, "scene.cylinder needs 'y'"),
        ({"scene": {"cylinder": {"diameter": -1, "x": 0, "y": 0}}}, "diameter must be above 0"),
        ({"scene": {"weights": {"left": -1}}}, "weights.left must not be below 0"),
        ({"scene": {"weights": {"up": 1}}}, "weights has no key 'up'"),
        ({"scene": {"cylinder": {"diameter": "a", "x": 0, "y": 0}}}, "must be a finite number"),
        ({"scene": {"sphere": {}}}, "no key 'sphere'"),
    ],
)
def test_nonsense_names_the_trial_and_the_key(changes, said):
    with pytest.raises(ConfigError, match=said) as caught:
        Trial.from_plain(plain_trial() | changes)
    assert "trial 'there_and_back'" in str(caught.value)


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("mode", "torque", "unknown; known: current"),
        ("current_limit", 25.0, "at most 20"),
        ("current_limit", None, "must be a number"),
        ("profile", {"kind": "saw"}, "motors.left.profile.kind 'saw'"),
    ],
)
def test_nonsense_for_a_motor_names_the_motor(key, value, said):
    motors = plain_trial()["motors"]
    motors["left"] |= {key: value}
    with pytest.raises(ConfigError, match=said) as caught:
        Trial.from_plain(plain_trial(motors=motors))
    assert "motors.left" in str(caught.value)


@pytest.mark.parametrize("name", ["", "../up", ".hidden", 3, None])
def test_a_name_must_be_able_to_name_a_file(name):
    with pytest.raises(ConfigError, match="name"):
        Trial.from_plain(plain_trial(name=name))
