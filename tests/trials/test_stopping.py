"""However a trial ends, the drives are at zero first, and the log holds what came before."""

import errno
import io
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from spirob.can.limits import Limits
from spirob.errors import DataError, HardwareError
from spirob.logs import read_log
from spirob.logs.recovery import recover
from spirob.plant import Rig
from tests.trials.fake_robot import FakeRobot
from tests.trials.stopped_trial import commands
from tests.trials.trials import record_on

HALF_SECOND = 500  # cycles


def started(folder, cycles):
    """A trial that has sent so many commands."""
    sent = folder / "sent"
    asked = [sys.executable, "-m", "tests.trials.stopped_trial", str(folder), str(sent)]
    trial = subprocess.Popen(asked, cwd=Path(__file__).parents[2], stderr=subprocess.PIPE)
    end = time.monotonic() + 60
    while not (sent.exists() and sent.stat().st_size >= 8 * cycles):
        assert trial.poll() is None, trial.stderr.read().decode()
        assert time.monotonic() < end
        time.sleep(0.005)
    return trial, sent


@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGTERM, 143), (signal.SIGINT, None)], ids=["term", "int"]
)
def test_a_signal_sends_zero_first_and_closes_the_log(tmp_path, number, code):
    trial, sent = started(tmp_path, 700)
    trial.send_signal(number)
    said = trial.communicate(timeout=30)[1].decode()
    assert trial.returncode == code or (code is None and "KeyboardInterrupt" in said)
    assert any(any(c) for c in commands(sent))
    assert commands(sent)[-1] == (0, 0)
    assert not (tmp_path / "trial.mcap").exists()
    trace = read_log(tmp_path / "trial.mcap.part")
    assert len(commands(sent)) - len(trace) <= 3  # the first answer, the zero, one in flight
    assert trace.meta["stopped"]


def test_a_killed_process_loses_no_more_than_half_a_second(tmp_path):
    trial, sent = started(tmp_path, random.Random(5).randrange(600, 1800))
    trial.kill()
    trial.wait()
    trial.stderr.close()
    recover(tmp_path / "trial.mcap.part", tmp_path / "back.mcap")
    played = len(commands(sent))
    back = read_log(tmp_path / "back.mcap")
    assert played - HALF_SECOND <= len(back) < played
    assert back.meta["trial"]["name"] == "there_and_back"


class SmallDisk(io.FileIO):
    """A disk with room for so many bytes."""

    room = 40_000

    def write(self, content):
        if self.tell() + len(content) > self.room:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return super().write(content)


def test_a_full_disk_sends_zero_first_and_keeps_what_was_written(tmp_path, monkeypatch):
    robot, order = FakeRobot(), []
    send, close = robot.exchange, SmallDisk.close

    def exchange(command):
        order.append("zero" if not any(command) else "current")
        return send(command)

    def closed(self):
        if not self.closed:
            order.append("closed")
        close(self)

    monkeypatch.setattr(robot, "exchange", exchange)
    monkeypatch.setattr(SmallDisk, "close", closed)
    monkeypatch.setattr("spirob.logs.writer.io.FileIO", SmallDisk)
    with pytest.raises(DataError, match=r"trial\.mcap: the log cannot be written: No space left"):
        record_on(robot, tmp_path, 3.0)
    assert order[-3:] == ["current", "zero", "closed"]
    assert not (tmp_path / "trial.mcap").exists()
    recover(tmp_path / "trial.mcap.part", tmp_path / "back.mcap")
    assert len(read_log(tmp_path / "back.mcap")) > 100


def test_a_stop_is_told_by_the_log_with_every_frame_of_its_last_cycle(tmp_path):
    from spirob.logs.messages import unpack_frames
    from spirob.logs.reader import read_content
    from spirob.trials import Trial, record
    from tests.trials.trials import plain_trial

    robot, handed = FakeRobot(), []
    send = robot.exchange

    def exchange(command):
        frames = send(command)
        handed.extend(frames)
        return frames

    robot.exchange = exchange
    with pytest.raises(HardwareError, match="motor right: tendon at 1"):
        record(
            Trial.from_plain(plain_trial(2.0)),
            robot,
            tmp_path / "t.mcap",
            Rig(name="fake"),
            limits=Limits(travel=0.01),
        )
    path = tmp_path / "t.mcap.part"
    assert "motor right: tendon at 1" in read_log(path).meta["stopped"]
    raw, _ = unpack_frames(read_content(path).messages["/can/raw"])
    assert [f["data"].tobytes() for f in raw] == [f.data for f in handed]
    assert robot.commands[-1] == (0.0, 0.0)
