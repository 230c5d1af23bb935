"""Laws of a ball and of a peg beside the model's arm, and the two arms side by side."""

import numpy as np
import pytest

from spirob.control import CURRENT, Schedule
from spirob.emulator.machine import Machine
from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.errors import ConfigError
from spirob.plant import Plant, Rig
from spirob.plant.plant import single_dynamics
from spirob.robot import Ball, Peg, Scene, scene_from
from spirob.trials import Trial
from spirob.trials.trial import wrap_trial

RIG = Rig.from_mapping({"winch": {"gear_ratio": 1.0}})
CYCLES = 400
PEG = Peg(diameter=0.01, x=0.4, y=0.017, radius=0.005, period=0.1, phase=np.pi / 2)


def held(current=0.8, cycles=CYCLES):
    return Schedule(
        np.full(2, CURRENT), np.full((cycles, 2), current), np.zeros((cycles, 2)), np.full(2, 5.0)
    )


def ball(x):
    return Scene(ball=Ball(0.016, 0.005, x, 0.23, 0.0, -2.0))


@pytest.fixture(scope="module")
def plant():
    return Plant(RIG)


def test_a_ball_that_passes_by_changes_nothing(plant):
    away = Scene(ball=Ball(0.016, 0.005, -0.5, 0.5, 0.0, 1.0))
    free, passed = (plant.simulate(held(), scene) for scene in (Scene(), away))
    assert np.array_equal(free.angles, passed.angles)
    assert np.array_equal(free.current, passed.current)


def test_a_peg_is_not_slowed_by_the_arm(plant):
    session = plant.start(Scene(peg=PEG))
    session.play(held())
    turned = session._data.qpos[RIG.units]
    assert np.abs(session._data.qpos[: RIG.units]).max() > 1e-3  # it did meet the arm
    assert turned == pytest.approx(2 * np.pi * CYCLES * 1e-3 / PEG.period, rel=1e-6)


@pytest.mark.parametrize("x", [0.35, 0.4, 0.44])
def test_model_and_emulated_robot_feel_a_ball_alike(plant, x):
    """Two solvers, two laws of contact: the tendon's largest motion agrees within a quarter."""
    modelled = plant.simulate(held(), ball(x)).displacement[:, 0]
    made = Machine(EmulatedRig(gear_ratio=1.0, current_noise=0.0), HiddenSettings("none"), 1)
    made.start(ball(x), "hit")
    wound = np.zeros(CYCLES)
    for k in range(CYCLES):
        made.cycle((0.8, 0.8))
        wound[k] = made.state["wound"][0, 0]
    ours, theirs = (np.abs(values - values[90]).max() for values in (modelled, wound))
    assert ours > 5e-3
    assert ours == pytest.approx(theirs, rel=0.25)


def test_the_single_dynamics_feels_it_too():
    force = np.full((CYCLES, 2), 0.6)
    hit, free = (single_dynamics(RIG, force, scene) for scene in (ball(0.44), Scene()))
    assert hit.angles.shape == free.angles.shape == (CYCLES, RIG.units)
    assert np.abs(hit.angles - free.angles).max() > 0.1


def test_what_is_held_is_not_entered_whatever_the_step():
    """A soft contact lets the arm through what is as large as this, and it winds on."""
    rng = np.random.default_rng(5)
    wrap = Trial.from_plain(wrap_trial("large", "heldout", 0.08, {}, rng))
    wound = [
        Plant(Rig(), substeps=n).simulate(wrap.schedule(), wrap.scene).displacement[:, 0]
        for n in (2, 8)
    ]
    assert np.ptp(wound[0][-300:]) < 1e-4
    assert wound[0][-1] == pytest.approx(wound[1][-1], rel=0.01)


def test_scenes_as_plain_data():
    plain = {"diameter": 0.016, "mass": 0.005, "x": 0.4, "y": 0.2, "vx": 0.0, "vy": -2.0}
    assert scene_from({"ball": plain}, "t").ball == Ball(0.016, 0.005, 0.4, 0.2, 0.0, -2.0)
    with pytest.raises(ConfigError, match="ball needs 'mass'"):
        scene_from({"ball": {k: v for k, v in plain.items() if k != "mass"}}, "t")
    with pytest.raises(ConfigError, match="mass must be above 0"):
        scene_from({"ball": {**plain, "mass": 0.0}}, "t")
    with pytest.raises(ConfigError, match="only one"):
        scene_from({"ball": plain, "cylinder": {"diameter": 1.0, "x": 0.0, "y": 2.0}}, "t")
