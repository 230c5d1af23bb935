"""A watch tells from frames what the log of the same frames tells, and when it happens."""

import numpy as np
import pytest

from spirob.can_protocol import COMMAND_ID, FEEDBACK_ID, CanFrame, encode_command
from spirob.emulator import EmulatedRobot
from spirob.experiments.active_contact import ActiveContact
from spirob.perceive.interval import calibrated, estimate
from spirob.perceive.live import Watch
from spirob.perceive.size import train
from spirob.trials import Trial
from spirob.trials.trial import wrap_trial
from tests.perceive.live.played import frames_and_features


@pytest.fixture(scope="module")
def model(known):
    return calibrated(train(known), known)


@pytest.fixture(scope="module")
def wrap(tmp_path_factory):
    plain = wrap_trial("wrap", "heldout", 0.04, {}, np.random.default_rng(0))
    return frames_and_features(plain, tmp_path_factory.mktemp("wrap"))


def told(watch, frames):
    """All that a watch tells of these frames."""
    return [one for frame in frames for one in watch.take(frame)]


def test_the_size_is_that_of_the_log_and_comes_before_its_end(wrap, model):
    frames, features = wrap
    found = [one for one in told(Watch(model=model), frames) if one.kind == "size"]
    (whole,) = estimate(model, features)
    assert len(found) == 1
    assert abs(float(found[0].text.split()[0]) - 1e3 * whole.diameter) < 0.3
    assert found[0].seconds < 3.5


def test_a_wrap_is_a_contact_too_and_the_idle_motor_has_none(wrap):
    found = told(Watch(), wrap[0])
    assert [(one.kind, one.motor) for one in found] == [("contact", "left")]
    assert "A over" in found[0].text


def test_lost_frames_hardly_move_the_size(wrap, model):
    frames, _ = wrap
    rng = np.random.default_rng(1)
    kept = [frame for frame in frames if rng.random() > 0.2]
    sizes = [
        float(one.text.split()[0])
        for given in (frames, kept)
        for one in told(Watch(model=model), given)
        if one.kind == "size"
    ]
    assert abs(sizes[0] - sizes[1]) < 0.5


def test_after_a_silence_everything_begins_anew(wrap, model):
    frames, _ = wrap
    hole = [f for f in frames if not 1.5e9 < f.stamp_ns < 1.7e9]
    found = told(Watch(model=model), hole)
    assert {one.kind for one in found if one.motor == "right"} == {"gap"}
    assert "size" not in {one.kind for one in found}


def test_what_is_no_wrap_is_a_sentence(model, tmp_path):
    settings = {"speed": 0.03, "duration": 5.0, "position": 0.67, "current_limit": 0.31}
    plain = wrap_trial("weak", "heldout", 0.04, settings, np.random.default_rng(0))
    frames, _ = frames_and_features(plain, tmp_path, features=False)
    found = [one for one in told(Watch(model=model), frames) if one.kind in ("size", "no size")]
    assert [one.kind for one in found] == ["no size"]
    assert len(found[0].text.splitlines()) == 1


def test_an_uncurling_arm_meets_a_peg_and_nothing_before(tmp_path):
    about = ActiveContact(places=(0.9,), recoil=0.1, again=0)
    kinds = {}
    for play in (one for one in about.plays() if one.name in ("uncurl_free", "uncurl_90")):
        frames, _ = frames_and_features(play.trial, tmp_path, features=False)
        found = [one for one in told(Watch(), frames) if one.motor == "right"]
        kinds[play.name] = [one for one in found if one.seconds < about.begins + about.uncurl]
    assert kinds["uncurl_free"] == []
    assert [one.kind for one in kinds["uncurl_90"]] == ["contact"]
    assert kinds["uncurl_90"][0].seconds > about.begins + about.settle


def test_other_frames_say_nothing():
    watch = Watch()
    for number, data in (
        (COMMAND_ID, encode_command((1.0, 1.0))),
        (FEEDBACK_ID + 3, bytes(8)),
        (FEEDBACK_ID + 1, bytes(7)),
        (FEEDBACK_ID + 1, b""),
    ):
        assert watch.take(CanFrame(0, number, data)) == []
    assert watch.frames == [0, 0]


def test_a_trial_leaves_the_watch_as_it_left_the_robot():
    """The watched robot needs nothing of the watch: what it sends is not changed by it."""
    trial = Trial.from_plain(wrap_trial("w", "heldout", 0.03, {}, np.random.default_rng(0)))
    robots = [EmulatedRobot(seed=3), EmulatedRobot(seed=3)]
    watch = Watch()
    for robot in robots:
        robot.prepare(trial.scene, "w")
    for _ in range(300):
        one, other = (robot.exchange(encode_command((0.6, 0.0))) for robot in robots)
        for frame in one:
            watch.take(frame)
        assert one == other
    for robot in robots:
        robot.close()
    assert watch.frames == [300, 300]
