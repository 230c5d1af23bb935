"""A drive in voltage mode: one frame for both motors; mistakes of a description are sentences."""

from importlib import resources

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spirob.can.drive import (
    Drive,
    Translator,
    find_drive,
    require_fast_enough,
    seconds_a_cycle,
    translated,
)
from spirob.can_protocol import (
    COMMAND_ID,
    VOLT_PER_COUNT,
    VOLTAGE_FEEDBACK_ID,
    VOLTAGE_ID,
    CanFrame,
    Feedback,
    decode_feedback,
    decode_volts,
    encode_feedback,
    encode_volts,
)
from spirob.errors import ConfigError
from spirob.logs.messages import pack_frame, unpack_frames

DRIVE = find_drive("gm6020")
TEXT = DRIVE.text
DBC = DRIVE.dbc_text
VOLT = st.floats(-24.0, 24.0)


@given(VOLT, VOLT)
def test_the_payload_is_the_drives_own_frame(left, right):
    payload = encode_volts((left, right))
    assert DRIVE.commands(payload) == [(VOLTAGE_ID, payload)]
    said = DRIVE.codec.decode("VOLTAGE", payload)
    assert said["voltage_1"] == pytest.approx(left, abs=VOLT_PER_COUNT / 2 + 1e-12)
    assert said["voltage_2"] == pytest.approx(right, abs=VOLT_PER_COUNT / 2 + 1e-12)
    assert decode_volts(payload) == pytest.approx((said["voltage_1"], said["voltage_2"]))


def test_what_is_beyond_the_scale_or_no_number():
    assert decode_volts(encode_volts((1e9, -1e9))) == pytest.approx((24.0, -24.0))
    assert decode_volts(encode_volts((float("nan"), 1.0)))[0] == 0.0


COUNTS = st.builds(
    Feedback,
    angle=st.integers(0, 8191),
    speed=st.integers(-32767, 32767),
    current=st.integers(-16384, 16384),
    temperature=st.integers(0, 255),
)


@given(COUNTS, st.sampled_from([1, 2]), VOLT, VOLT)
def test_a_frame_says_the_same_at_once_and_from_a_log(said, number, left, right):
    data, payload = encode_feedback(said), encode_volts((left, right))
    frames = [
        CanFrame(0, VOLTAGE_ID, payload),
        CanFrame(5, VOLTAGE_FEEDBACK_ID + number, data),
    ]
    ours = Translator(DRIVE)(frames)
    assert [f.arbitration_id for f in ours] == [COMMAND_ID, 0x200 + number]
    assert decode_feedback(ours[1].data) == said
    messages = [pack_frame(f.stamp_ns, f.arbitration_id, f.data) for f in frames]
    raw, _ = unpack_frames(messages)
    other = raw.copy()
    other["id"][1] = VOLTAGE_FEEDBACK_ID + 3 - number  # the other motor, so that both are there
    found = translated(DRIVE, np.concatenate([raw, other[1:]]))
    assert found["id"].tolist() == [COMMAND_ID, 0x200 + number, 0x200 + 3 - number]
    assert found["data"][0].tobytes() == payload
    assert decode_feedback(found["data"][1].tobytes()) == said


def test_millivolts_and_a_motor_that_counts_the_other_way():
    dbc = DBC.replace('(0.00096,0) [-24|24] "V"', '(1,0) [-24000|24000] "mV"')
    drive = Drive.from_texts(TEXT.replace("per_volt: 1.0", "per_volt: -1.0"), dbc, "own.yaml")
    ((_, data),) = drive.commands(encode_volts((1.2, -2.4)))
    said = drive.codec.decode("VOLTAGE", data)
    assert (said["voltage_1"], said["voltage_2"]) == (-1200.0, 2400.0)


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("voltage_1, per_volt: 1.0", "voltage_1", "both motors take a current, or both a voltage"),
        ("voltage_1, ", "voltage_1, per_ampere: 1.0, ", "per_ampere or per_volt, not both"),
        ("voltage_1, per_volt: 1.0", "voltage_1, per_volt: 0.0", "0 would erase it"),
    ],
)
def test_mistakes_are_sentences(before, after, words):
    with pytest.raises(ConfigError, match=words):
        Drive.from_texts(TEXT.replace(before, after), DBC, "own.yaml")


def test_a_voltage_needs_a_unit_of_voltage():
    with pytest.raises(ConfigError, match=r"gives 'A' for voltage_1; a voltage is in V or mV"):
        Drive.from_texts(TEXT, DBC.replace('"V" LEFT', '"A" LEFT'), "own.yaml")


def test_a_bus_slower_than_the_loop_is_refused():
    assert seconds_a_cycle(DRIVE, 1e6) == pytest.approx(3 * 135e-6)
    require_fast_enough(DRIVE, 500_000)
    with pytest.raises(ConfigError, match=r"250 kbit/s is slower .* up to 1\.62 ms"):
        require_fast_enough(DRIVE, 250_000)


def test_currents_are_as_they_were():
    assert not find_drive("odrive").by_voltage
    assert resources.files("spirob.can").joinpath("drives").joinpath("gm6020.yaml").is_file()
