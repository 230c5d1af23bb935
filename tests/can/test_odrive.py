"""The same trial on drives of another kind: raw frames kept, signals as the controller saw them."""

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.can.bus import open_bus
from spirob.can.drive import Drive, Translator, find_drive, translated
from spirob.can.limits import Limits
from spirob.can.robot import CanRobot
from spirob.can_protocol import AMPERE_PER_COUNT, CanFrame, decode_feedback, encode_command
from spirob.errors import ConfigError, MissingLog
from spirob.logs import read_log
from spirob.logs.messages import FRAME, pack_frame, unpack_frames
from spirob.logs.reader import read_content
from spirob.plant import Rig
from spirob.trials import Trial, record
from tests.can.fake_odrives import TORQUE_CONSTANT, FakeODrives
from tests.can.stalls import steady
from tests.trials.trials import plain_trial

DRIVE = find_drive("odrive")


@steady
def test_a_trial_on_odrives_reads_like_any_other(tmp_path):
    motors = plain_trial()["motors"]
    motors["left"] = dict(motors["right"])
    trial = Trial.from_plain(plain_trial(0.4, motors=motors))
    with FakeODrives("odrives") as axes:
        robot = CanRobot(
            open_bus("virtual", "odrives"),
            silence_ns=900_000_000,
            ask=lambda question: "arm",
            drive=DRIVE,
        )
        path = record(
            trial,
            robot,
            tmp_path / "t.mcap",
            Rig(),
            limits=Limits(silence=0.9),
            drive=DRIVE,
        )
        robot.close()
        assert axes.wait_for(lambda: axes.heard[-2:] == [(0, 7), (1, 7)])
    assert axes.heard.index((0, 24)) < axes.heard.index((0, 11)) < axes.heard.index((0, 7))
    assert axes.torques[-1] == (0.0, 0.0)
    assert axes.state == [1, 1]
    trace = read_log(path)
    assert 1e-4 < trace["left.displacement"].max() < 0.05
    assert trace["right.temperature"][-1] == 42.0
    asked = np.array(axes.torques) / TORQUE_CONSTANT
    for m, motor in enumerate(("left", "right")):
        for value in trace[f"{motor}.command"][::37]:
            assert np.abs(asked[:, m] - value).min() < 1e-6
        # what a drive reports was commanded before; how long before, a busy machine decides
        command, current = trace[f"{motor}.command"], trace[f"{motor}.current"]
        before = np.tril(np.ones((len(command), len(command)), bool), -1)
        apart = np.where(before, np.abs(current[:, None] - command), np.inf).min(axis=1)
        assert np.median(apart[10:]) < AMPERE_PER_COUNT
    raw, dropped = unpack_frames(read_content(path).messages["/can/raw"])
    assert dropped == 0
    assert set(np.unique(raw["id"])) == {9, 14, 20, 21, 41, 46, 52, 53}


FLOAT = st.one_of(st.floats(-1e4, 1e4, width=32), st.floats(width=32))
FRAMES = st.lists(
    st.tuples(st.sampled_from([9, 20, 21, 41, 52, 53, 99]), FLOAT, FLOAT), max_size=12
)


@settings(max_examples=150, deadline=None)
@given(cycles=st.lists(st.tuples(FRAMES, st.integers(-16384, 16384)), min_size=1, max_size=8))
def test_a_log_is_translated_as_the_controller_saw_it(cycles):
    live, raw, stamp = [], [], 0
    translator = Translator(DRIVE)
    for frames, count in cycles:
        payload = encode_command((count * AMPERE_PER_COUNT, -count * AMPERE_PER_COUNT))
        given = [CanFrame(stamp, *sent) for sent in DRIVE.commands(payload)]
        for number, first, second in frames:
            stamp += 1
            given.append(CanFrame(stamp, number, struct.pack("<ff", first, second)))
        seen = translator(given)
        live += [CanFrame(seen[0].stamp_ns, seen[0].arbitration_id, payload), *seen[1:]]
        raw += given
        stamp += 1
    packed = b"".join(pack_frame(f.stamp_ns, f.arbitration_id, f.data) for f in raw)
    back = translated(DRIVE, np.frombuffer(packed, FRAME))
    told = [CanFrame(int(r["stamp_ns"]), int(r["id"]), r["data"].tobytes()) for r in back]
    assert told == live


def test_units_come_from_the_dbc_and_signs_from_the_description():
    text = DRIVE.text.replace("signal: Vel_Estimate}", "signal: Vel_Estimate, sign: -1}")
    mirrored = Drive.from_texts(text, DRIVE.dbc_text.replace('"rev/s"', '"rad/s"'), "own.yaml")
    frames = [CanFrame(0, 14, bytes(8)), CanFrame(1, 9, struct.pack("<ff", 0.25, 2 * np.pi))]
    said = decode_feedback(Translator(mirrored)(frames)[1].data)
    assert (said.angle, said.speed) == (2048, -60)


@pytest.mark.parametrize(
    ("text", "dbc", "sentence"),
    [
        ("name: x", "", r"own\.yaml: key 'dbc': Field required"),
        ("[", "", r"own\.yaml: is not YAML"),
        (DRIVE.text.replace("Iq_Measured", "Torque", 1), None, "has no signal 'Torque'"),
        (DRIVE.text.replace("odrive.dbc", "../odrive.dbc"), None, "key 'dbc'"),
        (DRIVE.text.replace("0.0203", "0.0", 1), None, r"per_ampere': 0 would erase it"),
        (DRIVE.text.replace("0.0203", "1e-300", 1), None, r"per_ampere': 1e-300 is no size"),
        (DRIVE.text.replace("0.0203", "true", 1), None, "per_ampere': 'true' is no number"),
        (DRIVE.text.replace("0.0203", "1_000", 1), None, "per_ampere': '1_000' is no number"),
        (
            DRIVE.text.replace("Pos_Estimate", "Pos_Estimate, sign: true", 1),
            None,
            "'true' is no nu",
        ),
        (DRIVE.text.replace("0.0203", "2026-13-45", 1), None, "per_ampere': Input should be"),
        (DRIVE.text + "name: again\n", None, "'name' is given twice, first in line"),
        (DRIVE.text, "rubbish", "is no DBC file"),
        (DRIVE.text, DRIVE.dbc_text.replace("Get_Iq: 8", "Get_Iq: 12"), "not a frame of 8 bytes"),
        (DRIVE.text, DRIVE.dbc_text.replace('"rev"', '"furlong"'), "gives 'furlong' for Pos_Estim"),
    ],
)
def test_a_wrong_description_is_told_in_a_sentence(text, dbc, sentence):
    with pytest.raises(ConfigError, match=sentence):
        Drive.from_texts(text, DRIVE.dbc_text if dbc is None else dbc, "own.yaml")


def test_a_drive_of_your_own_is_found_by_its_file(tmp_path):
    (tmp_path / "mine.yaml").write_text(DRIVE.text.replace("odrive.dbc", "mine.dbc"))
    with pytest.raises(MissingLog, match=r"mine\.dbc: there is no such description"):
        find_drive(str(tmp_path / "mine.yaml"))
    (tmp_path / "mine.dbc").write_text(DRIVE.dbc_text)
    assert find_drive(str(tmp_path / "mine.yaml")).frame_id("Axis1_Get_Iq") == 52
    with pytest.raises(ConfigError, match="no drive 'servo'; known: c620, gm6020, odrive"):
        find_drive("servo")
