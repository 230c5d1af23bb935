"""A sensor's speed is used with its scale and on time, or left out; the position suffices."""

import numpy as np
import pytest

from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.recording import prepare
from tests.machine.rigs import description

RIG = RigFile.model_validate(description(velocity={"column": "v", "unit": "rad/s"}, filter={}))
BARE = RigFile.model_validate(description(filter={}))
RATE = 200
NOISE = np.random.default_rng(0).standard_normal(2400)


def motion(t):
    tones = 2 * np.pi * np.array([0.7, 1.9])
    sizes = np.array([2.0, 0.3])
    return (sizes * np.sin(np.outer(t, tones))).sum(1), (
        sizes * tones * np.cos(np.outer(t, tones))
    ).sum(1)


def prepared(speed, rig=RIG, step=1e-4):
    """A log whose encoder counts, and the speed that its column holds at its times."""
    t = np.arange(2400) / RATE
    q, _ = motion(t)
    columns = {"t": t, "q": step * np.round(q / step), "u": np.cos(4 * t), "v": speed(t)}
    made = prepare("log", columns, rig)
    piece = made.pieces[0]
    true = motion(piece.seconds)[1]
    return made.said, float(np.sqrt(np.mean((piece.v - true)[piece.use] ** 2)) / true.std())


def test_a_right_speed_is_used_as_it_is():
    said, error = prepared(lambda t: motion(t)[1])
    assert said == []
    assert error < 1e-3


@pytest.mark.parametrize("scale", [0.4, 0.5, 0.6, 1.3, -1.0, 57.3])
def test_a_scale_is_used_and_said(scale):
    said, error = prepared(lambda t: scale * motion(t)[1])
    assert said == [f"log: 'v' is {scale:.3g} times the derivative of the position; scaled."]
    assert error < 1e-3


@pytest.mark.parametrize("late", [-0.02, 0.005, 0.02, 0.06])
def test_a_late_speed_is_aligned(late):
    said, error = prepared(lambda t: 0.5 * motion(t - late)[1])
    assert any("aligned" in text and ("late" if late > 0 else "early") in text for text in said)
    assert error < 3e-3


@pytest.mark.parametrize(
    "speed",
    [lambda t: NOISE, lambda t: 0.0 * t, lambda t: motion(t)[0], lambda t: motion(t - 0.3)[1]],
)
def test_what_is_no_derivative_is_left_out(speed):
    said, error = prepared(speed)
    assert said == ["log: 'v' is no derivative of the position and was left out."]
    assert error == prepared(speed, BARE)[1]


def test_the_less_noisy_of_both_is_used():
    def noisy(t):
        return motion(t)[1] + 0.1 * NOISE

    said, error = prepared(noisy)
    assert said == ["log: 'v' is noisier than the derivative of the position and was left out."]
    assert error < 1e-2
    said, error = prepared(noisy, step=0.1)
    assert said == []
    assert error < prepared(noisy, BARE, step=0.1)[1]


@pytest.mark.parametrize("scale", [0.5, -1.0, 57.3])
def test_of_a_noisy_speed_the_scale_or_sign_is_told_too(scale):
    said, error = prepared(lambda t: scale * (motion(t)[1] + 0.1 * NOISE))
    told = f"derivative of the position, which it is {scale:.2g} times, and was left out."
    assert said == [f"log: 'v' is noisier than the {told}"]
    assert error < 1e-2


def test_a_speed_that_is_mostly_empty_is_left_out():
    said, _ = prepared(lambda t: np.where(np.arange(len(t)) % 10 == 0, motion(t)[1], np.nan))
    assert said == ["log: 'v' is mostly empty and left out."]


@pytest.mark.parametrize("rows", [2, 4, 8])
def test_a_logger_that_stalls_and_catches_up_loses_no_counts(rows):
    """Its rows hold the place of a later time; a reset of the zero goes on behind it at once."""
    t = np.arange(2400) / RATE
    q, speed = motion(t)
    late, reset = q.copy(), q.copy()
    at = [k for k in (300, 700, 1100, 1900) if abs(speed[k]) > 0.25 * np.abs(speed).max()]
    for k in at:
        late[k : k + rows] = q[k + rows]
        reset[k:] += rows * (q[k] - q[k - 1])
    made, zero = (prepare("log", {"t": t, "q": x, "u": np.cos(4 * t)}, BARE) for x in (late, reset))
    assert len(made.pieces) == 1
    assert any(f"{rows * len(at)} rows in all: the logger stalled" in said for said in made.said)
    piece = made.pieces[0]
    assert np.abs(piece.q - motion(piece.seconds)[0]).max() < 0.01
    assert not any("stalled" in said for said in zero.said)
