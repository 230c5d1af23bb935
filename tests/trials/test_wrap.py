"""A wrap's trial stands the cylinder beside the arm and varies only what it says."""

import numpy as np
import pytest
import yaml

from spirob.errors import ConfigError
from spirob.geometry import spiral_arm
from spirob.trials import Trial
from spirob.trials.trial import WrapSettings, beside, wrap_trial

STEADY = {"placement": 0.0, "speed_variation": 0.0, "friction_variation": 0.0}


def make(diameter=0.04, seed=0, **settings):
    return wrap_trial("wrap", "train", diameter, settings, np.random.default_rng(seed))


def test_it_is_a_valid_trial_of_plain_data():
    plain = make()
    assert yaml.safe_load(yaml.safe_dump(plain)) == plain
    trial = Trial.from_plain(plain)
    assert trial.scene.cylinder.diameter == 0.04
    assert trial.motors["left"].mode == "velocity"
    assert trial.motors["right"].mode == "current"
    assert not trial.schedule().reference[:, 1].any()


@pytest.mark.parametrize("diameter", [0.01, 0.04, 0.07])
def test_the_gap_is_measured_across_the_slanted_edge(diameter):
    cylinder = make(diameter, **STEADY, gap=0.003)["scene"]["cylinder"]
    arm = spiral_arm()
    x = arm.hinge_position + arm.unit_length / 2
    edges = np.linspace(x[0], x[-1], 20001)
    slope, edge = np.polyfit(x, arm.half_width, 1)
    distance = np.hypot(edges - cylinder["x"], edge + slope * edges - cylinder["y"]).min()
    assert distance - diameter / 2 == pytest.approx(0.003, abs=1e-6)
    assert beside(arm, x[5], 0.0) == pytest.approx(arm.half_width[5], rel=1e-3)


def test_the_seed_decides_and_the_variations_stay_within_bounds():
    assert make(seed=4) == make(seed=4) != make(seed=5)
    steady = make(**STEADY)["scene"]["cylinder"]
    for seed in range(50):
        cylinder = make(seed=seed)["scene"]["cylinder"]
        speed = make(seed=seed)["motors"]["left"]["profile"]["value"]
        assert abs(cylinder["x"] - steady["x"]) <= 0.002
        beside_it = beside(spiral_arm(), cylinder["x"], 0.02 + 0.003)
        assert abs(cylinder["y"] - beside_it) <= 0.002
        assert 0.2 <= cylinder["friction"] <= 0.4
        assert abs(speed / 0.045 - 1) <= 0.05


def test_switching_a_variation_off_leaves_the_others_as_they_were():
    varied, still = (make(seed=3, placement=p)["scene"]["cylinder"] for p in (0.002, 0.0))
    assert varied["friction"] == still["friction"]
    assert varied["x"] != still["x"]


def test_wrong_settings_are_told_in_a_sentence():
    with pytest.raises(ConfigError, match="no setting 'colour'; it has: position"):
        make(colour=1)
    with pytest.raises(ConfigError, match=r"placement = 0\.01 is out of range"):
        WrapSettings(placement=0.01)  # the cylinder could stand inside the arm
    with pytest.raises(ConfigError, match="speed must be a number"):
        make(speed="fast")
    with pytest.raises(ConfigError, match="diameter must be above 0"):
        make(diameter=0.0)
