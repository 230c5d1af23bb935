"""The rendered clip: made where OpenGL works, else the page says why it is absent."""

from dataclasses import replace

import pytest

from spirob.report import render, with_clip
from spirob.report.arm import NoClip, film


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
