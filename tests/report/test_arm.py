"""The arm's motion for the page: packed small, robot and model alike, tips compared.

The rendered clip: made where OpenGL works, else the page says why it is absent.
"""

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from spirob.report import render, with_clip
from spirob.report.arm import NoClip, apart, film, payload
from spirob.report.figures import unpack


def motion(hinges, angle, rate=30.0, trial="a"):
    time = np.arange(0, 2, 1 / rate)
    columns = {f"q{i}": np.full(len(time), angle) for i in range(hinges)}
    return pd.DataFrame({"trial": trial, "time": time} | columns)


def test_equally_bent_arms_of_24_and_48_hinges_nearly_meet():
    distance = apart(motion(24, 0.1), motion(48, 0.05))
    assert distance.max() < 0.02


def test_a_straight_arm_and_a_rod_at_right_angles_are_a_diagonal_apart():
    bent = motion(24, 0.0).assign(q0=np.pi / 2)
    assert apart(motion(24, 0.0), bent) == pytest.approx(0.46408 * np.sqrt(2), rel=1e-6)


def test_frames_of_different_rates_are_compared_at_the_same_times():
    assert apart(motion(24, 0.1, 30.0), motion(24, 0.1, 7.0)).max() < 1e-9


def test_a_trial_that_the_robot_did_not_show_is_left_out():
    assert len(apart(motion(24, 0.1), motion(24, 0.1, trial="b"))) == 0
    assert payload(motion(24, 0.1), motion(48, 0.1, trial="b"))["robot"] is None


def test_hinges_are_in_their_order_and_survive_packing(data):
    packed = payload(data.motion, data.posture)
    rows = data.motion[data.motion["trial"] == packed["trials"][0]["name"]]
    angles = unpack(packed["trials"][0]["angles"]).reshape(-1, 24)
    assert angles[:, 10] == pytest.approx(rows["q10"].to_numpy()[: len(angles)], abs=1e-4)
    assert len(packed["robot"]["geometry"]["length"]) == 48


def test_robot_and_model_together_stay_small(data):
    assert len(json.dumps(payload(data.motion, data.posture))) < 800_000


def test_without_opengl_the_reason_is_a_sentence(data, monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "disable")
    without = with_clip(data)
    assert without.clip is None
    reason = without.absent["clip"]
    assert reason.startswith("There is no rendered video: OpenGL does not work here (")
    assert "\n" not in reason
    assert "There is no rendered video: OpenGL does not work here" in render(without)


def test_the_clip_is_an_animation_and_the_page_holds_it(data):
    try:
        clip = film(data.motion)
    except NoClip as reason:
        pytest.skip(str(reason))
    assert clip[:4] == b"RIFF"
    assert clip[8:12] == b"WEBP"
    assert clip.count(b"ANMF") > 10  # frames that differ
    page = render(replace(data, clip=clip))
    assert "data:image/webp;base64," in page
    assert len(page.encode()) < 8_000_000


def test_no_video_is_made_unasked(page):
    assert "data:image/webp" not in page
    assert "spirob report --video" in page
