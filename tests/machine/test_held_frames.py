"""Frames that a logger held are lost samples; stands and chance repeats keep their rows."""

import numpy as np
import pytest

from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.clock import held, of_a_register
from spirob.machine.recordings.recording import prepare
from tests.machine.rigs import description

RIG = RigFile.model_validate(description())
RATE = 500


def motion(t):
    return 2 * np.sin(2 * np.pi * 0.7 * t) + 0.3 * np.sin(2 * np.pi * 1.9 * t)


def log(frames, seconds=6.0, count=1e-6):
    """Columns at RATE of frames that were taken at other times, by row."""
    t = np.arange(round(seconds * RATE)) / RATE
    at = t[frames(np.arange(len(t)))]
    q = count * np.round(motion(at) / count)
    return {"t": t, "q": q, "u": np.cos(4 * at) + 0.01 * np.sin(40 * at)}


def some(rows):
    """One frame in twenty is not there in time, some of them for two rows more."""
    rng = np.random.default_rng(0)
    lost = rng.random(len(rows)) < 0.05
    lost |= np.roll(lost & (rng.random(len(rows)) < 0.3), 1)
    lost[0] = False
    return np.maximum.accumulate(np.where(lost, 0, rows))


def seldom(rows):
    return rows // 10 * 10


def slow(rows):
    """A register of 30 Hz: it holds for 16 rows or for 17."""
    return np.ceil(np.floor(rows * 30 / RATE) * RATE / 30).astype(int)


def polled(rows):
    """Frames a tenth slower than the rows: one of eleven finds no new one, and none is lost."""
    return rows * 10 // 11


def of(columns):
    still = np.all([np.diff(v) == 0 for k, v in columns.items() if k != "t"], axis=0)
    return still, held(still, [columns["q"]])


@pytest.mark.parametrize("frames", [some, seldom, slow, polled])
@pytest.mark.parametrize("count", [1e-12, 1e-4])
def test_held_frames_are_lost_samples_and_no_jumps(frames, count):
    columns = log(frames, count=count)
    still, dropped = of(columns)
    assert dropped.sum() >= 0.95 * still.sum()
    made = prepare("log", columns, RIG)
    assert any("hold the frame before" in text for text in made.said)
    assert not any("jump" in text for text in made.said)
    assert len(made.pieces) == 1


def test_the_speed_behind_held_frames_is_that_of_the_axis():
    piece = prepare("log", log(some), RIG).pieces[0]
    true = np.gradient(motion(piece.seconds), piece.seconds)
    assert np.std((piece.v - true)[piece.use]) < 0.02 * true.std()


@pytest.mark.parametrize("rows", [1, 2, 5, 200])
def test_an_axis_that_stands_keeps_its_rows(rows):
    move = 0.5 * (1 - np.cos(np.pi * np.arange(1, 101) / 100))  # its speed begins and ends at none
    q = np.concatenate([np.append(k + move, np.full(rows, k + 1.0)) for k in range(30)])
    still = np.diff(q) == 0
    assert still.sum() == 30 * rows
    assert not held(still, [q]).any()


@pytest.mark.parametrize("speed", [0.1, 0.45, 0.8, 0.95])
def test_coarse_channels_that_are_the_same_by_chance_keep_their_rows(speed):
    rows = np.arange(4000)
    q = np.floor(speed * rows + 200 * np.sin(0.002 * rows))
    effort = np.round(3 * np.cos(0.002 * rows))
    still = (np.diff(q) == 0) & (np.diff(effort) == 0)
    assert still.sum() > 100
    assert not held(still, [q]).any()


@pytest.mark.parametrize("count", [0.01, 0.02])
@pytest.mark.parametrize("seed", range(3))
def test_repeats_of_a_coarse_encoder_under_a_stepped_effort_are_no_held_frames(count, seed):
    """Sampled at uneven times, as a read over USB is: one and two counts follow one another."""
    rng = np.random.default_rng(seed)
    t = np.arange(4000) / RATE
    q = count * np.floor(motion(t + rng.uniform(-0.3, 0.3, len(t)) / RATE) / count)
    still = (np.diff(q) == 0) & (np.diff(t // 0.5) == 0)
    assert still.sum() > 50
    assert not held(still, [q]).any()


def test_a_stand_in_a_log_of_held_frames_keeps_rows_at_their_rate():
    columns = log(seldom)
    rest = np.full(1000, columns["q"][-1])
    q = np.concatenate([columns["q"], rest, columns["q"][::-1]])
    dropped = held(np.diff(q) == 0, [q])
    assert 80 <= np.count_nonzero(~dropped[3000:4000]) <= 120
    assert np.count_nonzero(~dropped[:3000]) == 300


def test_a_register_holds_a_motion_that_turns_round_from_frame_to_frame():
    t = np.arange(3000) / RATE
    at = t[slow(np.arange(len(t)))]
    q = np.sin(2 * np.pi * 1.3 * at) + np.sin(2 * np.pi * 11.3 * at)
    still = np.diff(q) == 0
    assert held(still, [q]).sum() >= 0.95 * still.sum()


def test_a_register_holds_beside_a_stand_that_is_longer_than_all_motion():
    columns = log(slow)
    columns = {k: np.concatenate([v, np.full(5000, v[-1])]) for k, v in columns.items()}
    columns["t"] = np.arange(len(columns["q"])) / RATE
    made = prepare("log", columns, RIG)
    assert any("hold the frame before" in text for text in made.said)
    assert made.period == pytest.approx(1 / 30, rel=0.02)


def test_a_jump_behind_a_stand_is_no_held_frame():
    columns = log(lambda rows: np.where(rows < 1500, rows, np.maximum(rows - 300, 1500)))
    columns["q"][1700:] += 0.5
    assert not of(columns)[1].any()
    assert any("jumps by 0.5" in text for text in prepare("log", columns, RIG).said)


def beside_a_faster_effort(q):
    t = np.arange(len(q)) / RATE
    u = np.cos(4 * t) + 0.01 * np.random.default_rng(0).normal(size=len(t))
    return prepare("log", {"t": t, "q": q, "u": u}, RIG)


@pytest.mark.parametrize("frames", [seldom, slow])
def test_a_position_of_a_slower_register_beside_a_faster_effort_is_read_once(frames):
    made = beside_a_faster_effort(log(frames)["q"])
    assert any("'q' is of a register slower than the log" in text for text in made.said)
    assert made.period > 8.0 / RATE
    piece = made.pieces[0]
    true = np.gradient(motion(piece.seconds), piece.seconds)
    late = np.gradient(motion(piece.seconds - 0.5 * made.period), piece.seconds)
    off = min(np.std((piece.v - v)[piece.use]) for v in (true, late))
    assert off < 0.1 * true.std()


@pytest.mark.parametrize("count", [0.003, 0.01, 0.05, 0.2])
@pytest.mark.parametrize("rows", [some, polled, lambda rows: rows])
def test_a_coarse_encoder_beside_a_faster_effort_is_no_register(count, rows):
    t = np.arange(6000) / RATE
    for q in (motion(t), 0.7 * t, 0.1 * t + 0.02 * np.sin(3 * t)):
        seen = count * np.floor(q[rows(np.arange(len(t)))] / count)
        assert not of_a_register(seen).any()


def test_a_position_in_every_twentieth_row_is_read():
    columns = log(lambda rows: rows)
    columns["q"] = np.where(np.arange(len(columns["q"])) % 20 == 0, columns["q"], np.nan)
    made = prepare("log", columns, RIG)
    assert made.period == pytest.approx(20 / RATE)
    assert len(made.pieces) == 1
