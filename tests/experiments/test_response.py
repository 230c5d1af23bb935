"""The recoil begins when the detector speaks, in the model as on the robot, and not before."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from spirob.emulator import EmulatedRobot
from spirob.experiments import Side
from spirob.experiments.active_contact import RIGHT, ActiveContact
from spirob.experiments.response import PERIOD, Recoil, Repeat, detected
from spirob.logs import read_log
from spirob.perceive.contact import ContactSettings
from spirob.plant import Plant, Rig
from spirob.trials import Trial, record
from spirob.trials.simulation import simulate

ABOUT = ActiveContact(places=(0.9,), recoil=0.4, again=0)
FREE, RAW, _, FILTERED = ABOUT.plays()
DAMPING = {"motor.rotor_damping": 5e-5}


def trial_of(play):
    return Trial.from_plain(play.trial)


def in_the_model(play):
    react = play.react()
    trace = simulate(Plant(Rig()), Trial.from_plain(play.trial), DAMPING, 0.005, 1, react)
    return trace, react


def on_the_robot(play, folder):
    robot, react = EmulatedRobot(seed=1), play.react()
    trial = Trial.from_plain(play.trial)
    path = record(
        trial,
        robot,
        folder / f"{trial.name}.mcap",
        Rig(),
        react=react,
    )
    robot.close()
    return read_log(path), react


@pytest.mark.parametrize(("play", "signal"), [(RAW, "current"), (FILTERED, "filtered")])
@pytest.mark.parametrize("where", ["model", "robot"])
def test_what_is_told_while_it_happens_is_what_the_log_tells(play, signal, where, tmp_path):
    trace, react = in_the_model(play) if where == "model" else on_the_robot(play, tmp_path)
    first, last = ABOUT.window()
    side = Side.from_trace(trace)
    assert first < react.told < last
    at = detected(side.driven(signal, RIGHT), first, last, ContactSettings())
    assert round(at / PERIOD) == react.told
    # from then on the tendon is paid out, and the trial ends so much earlier
    assert len(trace) == Trial.from_plain(play.trial).cycles - (last - react.told)
    asked = trace["right.reference"]
    assert asked[react.told - 1] == pytest.approx(ABOUT.speed)
    assert asked[react.told + 200] == pytest.approx(-ABOUT.speed)
    assert trace["right.displacement"][-1] < trace["right.displacement"][react.told] - 2e-3


def test_without_a_contact_the_trial_is_that_without_a_detector():
    trace, react = in_the_model(FREE)
    alone = simulate(Plant(Rig()), Trial.from_plain(FREE.trial), DAMPING, 0.005, 1)
    assert react.told is None
    for name in ("right.current", "right.displacement", "left.velocity"):
        assert np.array_equal(trace[name], alone[name])


def test_a_model_that_repeats_a_motion_recoils_when_that_one_did():
    """Its own motion repeated is the same to the bit, whatever it feels."""
    trace, react = in_the_model(RAW)
    again, _ = in_the_model(replace(RAW, react=partial(RAW.repeat, Side.from_trace(trace))))
    for name in ("right.current", "right.reference", "left.displacement"):
        assert np.array_equal(trace[name], again[name])
    first, last = ABOUT.window()
    earlier, later = Repeat(react.told - 300, first, last), Repeat(None, first, last)
    for repeat, cycles in ((earlier, len(trace) - 300), (later, trial_of(RAW).cycles)):
        moved, _ = in_the_model(replace(RAW, react=lambda repeat=repeat: repeat))
        assert len(moved) == cycles


def test_the_filtered_detector_hears_the_mean_of_the_trial():
    """Not one that begins with the watch: the log's mean has no beginning there."""
    rng = np.random.default_rng(0)
    values = 0.6 + 0.02 * rng.standard_normal(3000)
    values[2000:] += np.minimum(0.002 * np.arange(1000), 0.8)
    react = Recoil(RIGHT, True, 1000, 3000, ContactSettings())
    for row in range(react.begins, 3000):
        if react(row, (0.0, values[row])) != row:
            break
    mean = np.convolve(values, np.ones(100) / 100)[:3000]
    told = detected(mean, 1000, 3000, ContactSettings())
    assert react.told == round(told / PERIOD) > 2000
