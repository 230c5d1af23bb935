"""What went in comes out: raw frames to the bit, signals in SI, the same bytes every time."""

import numpy as np
import pytest

from spirob.can_protocol import (
    AMPERE_PER_COUNT,
    COMMAND_ID,
    FEEDBACK_ID,
    CanFrame,
    decode_command,
    decode_feedback,
)
from spirob.errors import DataError, HardwareError, MissingChannel, MissingLog, TooShort
from spirob.identify.measurement import scene_of, schedule_of
from spirob.logs import Transmission, TrialLog, read_log
from spirob.logs.messages import COMMAND_TOPIC, RAW_TOPIC, unpack_frames
from spirob.logs.reader import read_content
from spirob.logs.trace import moving_average
from spirob.robot import CYCLE_NS
from spirob.trials import Trial
from tests.trials.fake_robot import FakeRobot
from tests.trials.trials import plain_trial, record_on


class Recorder(FakeRobot):
    """Keeps every frame that it handed out, and lets a test tamper with them."""

    def __init__(self, tamper=None):
        super().__init__()
        self.frames = []
        self.tamper = tamper

    def exchange(self, command):
        frames = super().exchange(command)
        if self.tamper:
            frames = self.tamper(len(self.commands), frames)
        self.frames += frames
        return frames


def test_raw_frames_come_back_to_the_bit(tmp_path):
    robot = Recorder()
    content = read_content(record_on(robot, tmp_path))
    raw, dropped = unpack_frames(content.messages[RAW_TOPIC])
    assert dropped == 0
    back = [CanFrame(int(r["stamp_ns"]), int(r["id"]), r["data"].tobytes()) for r in raw]
    assert back == robot.frames[:-3]  # the last zero is sent after the trial


def test_signals_are_what_the_frames_say(tmp_path):
    robot = Recorder()
    trace = read_log(record_on(robot, tmp_path))
    rows = 400
    for m, motor in enumerate(("left", "right")):
        said = [
            decode_feedback(f.data) for f in robot.frames if f.arbitration_id == FEEDBACK_ID + 1 + m
        ][:rows]
        sent = [decode_command(f.data) for f in robot.frames if f.arbitration_id == COMMAND_ID]
        current = np.array([s.current for s in said]) * AMPERE_PER_COUNT
        np.testing.assert_array_equal(trace[f"{motor}.current"], current)
        np.testing.assert_array_equal(
            trace[f"{motor}.current_filtered"], moving_average(current, 100)
        )
        np.testing.assert_array_equal(trace[f"{motor}.command"], [c[m] for c in sent[1 : rows + 1]])
        np.testing.assert_array_equal(trace[f"{motor}.temperature"], 25 + m)
        true = np.array([d[m] for d in robot.displacements[:rows]])
        count = Transmission().metre_per_count
        assert np.abs(trace[f"{motor}.displacement"] - (true - true[0])).max() <= 1.01 * count
    assert trace.units["left.reference"] == "m/s"
    assert trace.units["right.reference"] == "A"
    assert np.array_equal(trace.time_ns, CYCLE_NS * np.arange(1, rows + 1))


def test_a_row_pairs_the_state_with_the_command_that_follows_it(tmp_path):
    trace = read_log(record_on(FakeRobot(), tmp_path))
    # The fake drive reports the very current it was commanded, one row later.
    np.testing.assert_array_equal(trace["left.current"][1:], trace["left.command"][:-1])


def test_the_same_trial_gives_the_same_bytes(tmp_path):
    one, two = (record_on(FakeRobot(), tmp_path / name) for name in ("a", "b"))
    assert one.read_bytes() == two.read_bytes()


def test_a_log_says_where_it_comes_from(tmp_path):
    path = record_on(FakeRobot(), tmp_path)
    trace = read_log(path)
    assert trace.name == "there_and_back"
    assert (trace.meta["role"], trace.meta["rig"]) == ("train", "fake")
    assert trace.meta["trial"] == plain_trial()
    assert {"git_commit", "python", "numpy", "mujoco", "spirob"} <= set(trace.meta["about"])
    assert read_content(path).attachments["config.yaml"] == b"rig: fake\n"
    assert scene_of(trace).cylinder.diameter == 0.04


def test_the_schedule_comes_back_from_the_log(tmp_path):
    back = schedule_of(read_log(record_on(FakeRobot(), tmp_path)))
    asked = Trial.from_plain(plain_trial()).schedule()
    for name in ("mode", "reference", "reference_rate", "current_limit"):
        np.testing.assert_array_equal(getattr(back, name), getattr(asked, name))


def test_missing_frames_hold_the_value_before_and_are_counted(tmp_path):
    lost = {50, 51, 52, 200}

    def tamper(k, frames):
        return frames[:1] + frames[2:] if k in lost else frames

    motors = plain_trial()["motors"]
    motors["left"] = dict(motors["right"])  # current mode: the loss does not change the trial
    whole = read_log(record_on(Recorder(), tmp_path, motors=motors))
    trace = read_log(record_on(Recorder(tamper), tmp_path, motors=motors))
    counts = trace.meta["frames"]
    assert (counts["left.missing"], counts["right.missing"]) == (4, 0)
    row = 50 - 1  # exchange 50 is the feedback of row 49
    assert np.all(trace["left.displacement"][row : row + 3] == trace["left.displacement"][row - 1])
    np.testing.assert_array_equal(
        trace["left.displacement"][row + 3 : 180], whole["left.displacement"][row + 3 : 180]
    )


def test_of_duplicate_frames_the_last_counts(tmp_path):
    def tamper(k, frames):
        return [*frames, frames[1]] if k % 7 == 0 else frames

    trace = read_log(record_on(Recorder(tamper), tmp_path))
    whole = read_log(record_on(Recorder(), tmp_path, name="whole.mcap"))
    assert trace.meta["frames"]["left.duplicate"] == 57
    np.testing.assert_array_equal(trace["left.displacement"], whole["left.displacement"])


def test_frames_of_other_sizes_and_strangers_do_no_harm(tmp_path):
    def tamper(k, frames):
        return [*frames, CanFrame(frames[0].stamp_ns, 0x201, b"abc"), CanFrame(0, 0x7F, bytes(8))]

    trace = read_log(record_on(Recorder(tamper), tmp_path))
    whole = read_log(record_on(Recorder(), tmp_path, name="whole.mcap"))
    assert trace.meta["frames"]["malformed"] == 401
    for channel in whole.signals:
        np.testing.assert_array_equal(trace[channel], whole[channel])


def test_skipped_cycles_leave_an_even_time_base(tmp_path):
    class Stalls(FakeRobot):
        def exchange(self, command):
            frames = super().exchange(command)
            if len(self.commands) == 150:
                self.now_ns += 5 * CYCLE_NS
            return frames

    trace = read_log(record_on(Stalls(), tmp_path))
    assert len(trace) == 405
    assert np.all(np.diff(trace.time_ns) == CYCLE_NS)
    assert trace.meta["frames"]["empty_cycles"] == 5


def test_a_motor_that_falls_silent_is_counted_and_named(tmp_path):
    def tamper(k, frames):
        return frames[:2] if k > 200 else frames

    with pytest.raises(HardwareError, match="motor right: no feedback for 10 ms"):
        record_on(Recorder(tamper), tmp_path)
    trace = read_log(tmp_path / "trial.mcap.part")
    assert 8 <= trace.meta["frames"]["right.missing"] <= 10
    assert "motor right" in trace.meta["stopped"]


def log_of(path, cycles, raw=True, command=True):
    """A log made by hand, with or without some of its topics."""
    with TrialLog(path, trial=plain_trial(), transmission=Transmission(), rig="r") as log:
        robot = FakeRobot()
        for _ in range(cycles):
            frames = robot.exchange(bytes(8))
            if raw:
                log.frames(frames if raw is True else frames[:1])
            if command:
                two = (0.0, 0.0)
                log.cycle(frames[0].stamp_ns, two, two, two, two, two, two, (0, 0))
    return path


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"raw": False}, RAW_TOPIC),
        ({"command": False}, COMMAND_TOPIC),
        ({"raw": "commands"}, "left feedback frame 0x201"),
    ],
)
def test_a_missing_channel_is_named_with_the_file(tmp_path, options, said):
    path = log_of(tmp_path / "bare.mcap", 200, **options)
    with pytest.raises(MissingChannel, match=said) as caught:
        read_log(path)
    assert str(path) in str(caught.value)


def test_a_missing_log_is_named(tmp_path):
    with pytest.raises(MissingLog, match=r"nowhere\.mcap"):
        read_log(tmp_path / "nowhere.mcap")


def test_a_trial_shorter_than_the_filter_is_named(tmp_path):
    path = record_on(FakeRobot(), tmp_path, 0.099)
    with pytest.raises(TooShort, match=r"trial\.mcap: 99 samples.*at least 100"):
        read_log(path)


@pytest.mark.parametrize("content", [b"", b"hello", b"\x89MCAP0\r\n"])
def test_what_is_no_log_is_named(tmp_path, content):
    path = tmp_path / "odd.mcap"
    path.write_bytes(content)
    with pytest.raises(DataError, match=r"odd\.mcap"):
        read_log(path)


def test_a_folder_is_no_log(tmp_path):
    with pytest.raises(DataError, match="cannot be read"):
        read_log(tmp_path)


def test_a_log_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(DataError, match="cannot write the log"):
        record_on(FakeRobot(), tmp_path / "file")
