"""A log can say what made it, also where there is no git.

A log written in a thread of its own: the same bytes, and an error that comes back.
"""

import errno
import platform
import threading

import pytest

import spirob
from spirob.errors import DataError
from spirob.logs.cycles import Transmission
from spirob.logs.writer import Background, ThreadedLog, TrialLog, git_commit, versions
from tests.trials.fake_robot import FakeRobot


def test_versions_name_what_decides_the_numbers():
    found = versions()
    assert found["python"] == platform.python_version()
    assert found["spirob"] == spirob.__version__
    assert {"numpy", "mujoco"} <= set(found)


def test_no_work_tree_has_no_commit(tmp_path):
    assert git_commit(tmp_path) == "unknown"
    assert git_commit(tmp_path / "absent") == "unknown"


ABOUT = {"git_commit": "0" * 40}


def written(kind, path, cycles=700, timing=None):
    robot = FakeRobot()
    trial = {"name": path.stem, "role": "train"}
    with kind(path, trial=trial, transmission=Transmission(), rig="fake", about=ABOUT) as log:
        for k in range(cycles):
            frames = robot.exchange(bytes(8))
            log.frames(frames)
            pair = [1e-3 * k, -1e-3 * k]
            log.cycle(frames[0].stamp_ns, pair, pair, pair, pair, pair, pair, [0, 0])
        log.timing = timing or {}
    return path.read_bytes()


def test_the_bytes_are_the_same(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    timing = {"cycles": "700"}
    here = written(TrialLog, tmp_path / "a/t.mcap", timing=timing)
    assert written(ThreadedLog, tmp_path / "b/t.mcap", timing=timing) == here


def test_a_full_disk_comes_back_and_the_log_stays_partial(tmp_path, monkeypatch):
    def full(self, frames):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(TrialLog, "frames", full)
    with pytest.raises(OSError, match="No space"):
        written(ThreadedLog, tmp_path / "t.mcap")
    assert not (tmp_path / "t.mcap").exists()
    assert (tmp_path / "t.mcap.part").exists()


def test_an_error_of_the_last_cycle_is_not_lost(tmp_path, monkeypatch):
    def full(self, *about):
        raise DataError("the disk is full")

    monkeypatch.setattr(TrialLog, "cycle", full)
    with pytest.raises(DataError, match="full"):
        written(ThreadedLog, tmp_path / "t.mcap", cycles=1)
    assert not (tmp_path / "t.mcap").exists()


def test_work_is_done_in_order_apart_and_not_after_an_error():
    done, background = [], Background()
    for k in range(1000):
        background(done.append, k)
    background(lambda: done.append(threading.current_thread() is threading.main_thread()))
    background(int, "x")
    with pytest.raises(ValueError, match="invalid literal"):
        background.close()
    with pytest.raises(ValueError, match="invalid literal"):
        background(done.append, "late")
    assert done == [*range(1000), False]
