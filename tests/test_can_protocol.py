"""The compiled codec is the DBC file: both agree on random payloads, both ways."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.can_protocol import (
    AMPERE_PER_COUNT,
    Feedback,
    database,
    decode_command,
    decode_feedback,
    decode_feedback_array,
    encode_command,
    encode_feedback,
)
from spirob.errors import DataError

dbc = cache(database)
settings.register_profile("slow start", deadline=None)  # the DBC file is loaded at first use
settings.load_profile("slow start")
PAYLOAD = st.binary(min_size=8, max_size=8)
COUNTS = st.integers(-16384, 16384)


@given(PAYLOAD, st.sampled_from(["FEEDBACK_1", "FEEDBACK_2"]))
def test_feedback_decodes_as_the_dbc_says(data, message):
    expected = dbc().decode_message(message, data, scaling=False)
    ours = decode_feedback(data)
    assert {name: getattr(ours, name) for name in expected} == expected


@given(
    st.integers(0, 8191),
    st.integers(-32768, 32767),
    COUNTS,
    st.integers(0, 255),
    st.sampled_from(["FEEDBACK_1", "FEEDBACK_2"]),
)
def test_feedback_encodes_as_the_dbc_says(angle, speed, current, temperature, message):
    values = {"angle": angle, "speed": speed, "current": current, "temperature": temperature}
    expected = dbc().encode_message(message, values, scaling=False, padding=False)
    assert encode_feedback(Feedback(**values)) == expected


@given(st.lists(COUNTS, min_size=4, max_size=4))
def test_command_is_what_the_dbc_says_both_ways(counts):
    amperes = tuple(c * AMPERE_PER_COUNT for c in counts)
    values = {f"current_{k + 1}": a for k, a in enumerate(amperes)}
    data = encode_command(amperes)
    assert data == dbc().encode_message("COMMAND", values)
    decoded = dbc().decode_message("COMMAND", data)
    assert decode_command(data, motors=4) == tuple(decoded[f"current_{k}"] for k in range(1, 5))


@given(st.lists(PAYLOAD, min_size=1, max_size=20))
def test_many_at_once_are_the_same_as_one_by_one(payloads):
    array = np.frombuffer(b"".join(payloads), np.uint8).reshape(-1, 8)
    many = decode_feedback_array(array)
    for row, data in zip(many, payloads, strict=True):
        one = decode_feedback(data)
        assert (row["angle"], row["speed"], row["current"], row["temperature"]) == (
            one.angle,
            one.speed,
            one.current,
            one.temperature,
        )


@given(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
def test_commands_round_to_counts_and_stop_at_full_scale(left, right):
    for asked, got in zip(
        (left, right), decode_command(encode_command((left, right))), strict=True
    ):
        clipped = min(max(asked, -20.0), 20.0)
        assert abs(got - clipped) <= AMPERE_PER_COUNT / 2 + 1e-12


@pytest.mark.parametrize("decode", [decode_feedback, decode_command])
def test_a_payload_of_another_size_is_refused(decode):
    with pytest.raises(DataError, match="7 bytes"):
        decode(bytes(7))
