"""The compiled codec is the DBC file: equal to cantools on random payloads, both ways."""

import math
from importlib import resources

import cantools
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.can.description import Codec
from spirob.errors import ConfigError, DataError, SpirobError

FILES = {
    "c620": resources.files("spirob").joinpath("c620.dbc").read_text(),
    "odrive": resources.files("spirob.can").joinpath("drives").joinpath("odrive.dbc").read_text(),
    "gm6020": resources.files("spirob.can").joinpath("drives").joinpath("gm6020.dbc").read_text(),
    "odd": """VERSION ""

BS_:

BU_: A

BO_ 1 packed: 8 A
 SG_ a : 0|12@1- (0.5,3) [0|0] "A" A
 SG_ b : 12|20@1+ (1,0) [0|0] "" A
 SG_ c : 39|16@0- (-0.25,-7) [0|0] "" A

BO_ 2 wide: 8 A
 SG_ d : 7|32@0- (0.001,1) [0|0] "" A
 SG_ e : 32|8@1- (2,0) [0|0] "" A
 SG_ f : 47|16@0+ (1,-100) [0|0] "" A
 SG_ g : 56|8@1+ (0.1,0.2) [0|0] "" A

BO_ 3 long: 8 A
 SG_ h : 0|64@1- (1,0) [0|0] "" A
""",
}
CODECS = {
    name: (Codec(text, name), cantools.database.load_string(text)) for name, text in FILES.items()
}
MESSAGES = [
    (name, message.name)
    for name, (_, truth) in CODECS.items()
    for message in truth.messages
    if message.signals
]


def same(one, other):
    return one == other or (math.isnan(one) and math.isnan(other))


@pytest.mark.parametrize(("file", "message"), MESSAGES)
def test_many_at_once_are_what_cantools_says_one_by_one(file, message):
    codec, truth = CODECS[file]

    @settings(max_examples=60, deadline=None)
    @given(st.lists(st.binary(min_size=8, max_size=8), min_size=1, max_size=8))
    def holds(payloads):
        many = codec.decode_many(
            message, np.frombuffer(b"".join(payloads), np.uint8).reshape(-1, 8)
        )
        size = truth.get_message_by_name(message).length
        for k, payload in enumerate(payloads):
            expected = truth.decode_message(message, payload[:size], decode_choices=False)
            assert set(expected) == set(many)
            assert all(same(many[name][k], float(value)) for name, value in expected.items())
            assert all(same(v, many[n][k]) for n, v in codec.decode(message, payload).items())

    holds()


def test_messages_on_bytes_are_compiled_and_others_are_not():
    assert all(CODECS[f][0].compiled(m) for f, m in MESSAGES if f != "odd")
    odd = CODECS["odd"][0]
    assert [odd.compiled(m) for m in ("packed", "wide", "long")] == [False, True, False]


@settings(max_examples=60, deadline=None)
@given(st.floats(-1e3, 1e3, width=32))
def test_a_value_comes_back(value):
    codec, _ = CODECS["odrive"]
    data = codec.encode("Axis0_Set_Input_Torque", {"Input_Torque": value})
    assert codec.decode("Axis0_Set_Input_Torque", data) == {"Input_Torque": value}


def test_mistakes_are_sentences():
    codec, _ = CODECS["odrive"]
    with pytest.raises(ConfigError, match="no message 'Tail'; known: Axis0_Heartbeat"):
        codec.unit("Tail", "x")
    with pytest.raises(ConfigError, match="has no signal 'x'; it has: Iq_Setpoint, Iq_Measured"):
        codec.unit("Axis0_Get_Iq", "x")
    with pytest.raises(DataError, match="3 bytes; the DBC file says 8"):
        codec.decode("Axis0_Get_Iq", b"abc")


@settings(max_examples=150, deadline=None)
@given(
    st.floats(0, 1, exclude_max=True),
    st.text(max_size=12),
    st.integers(0, 40),
    st.text(max_size=80),
)
def test_any_text_is_a_codec_or_a_sentence(at, put, cut, junk):
    whole = FILES["odd"]
    place = int(at * len(whole))
    for text in (whole[:place] + put + whole[place + cut :], junk):
        try:
            Codec(text, "x.dbc")
        except SpirobError as error:
            assert "x.dbc" in str(error)
