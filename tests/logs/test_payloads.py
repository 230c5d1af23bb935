"""The quick way through a chunk finds what the slow way finds, or gives way to it.

Logs are read from several threads at once, as parallel sweeps do.
"""

import struct
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.opcode import Opcode

from spirob.can_protocol import database
from spirob.logs import read_log
from spirob.logs.messages import FRAME, pack_frame, unpack_frames
from spirob.logs.payloads import locate
from spirob.logs.reader import read_content
from tests.trials.fake_robot import FakeRobot
from tests.trials.trials import record_on

MESSAGES = st.lists(st.tuples(st.integers(1, 3), st.binary(max_size=20)), max_size=30)
OTHERS = st.lists(st.tuples(st.integers(0, 30), st.binary(max_size=12)), max_size=3)


def record(opcode, content):
    return struct.pack("<BQ", opcode, len(content)) + content


def chunk_of(messages, others):
    """A chunk, its message indices, and payloads by channel."""
    chunk, entries, payloads = b"", {}, {}
    for k, (channel, data) in enumerate(messages):
        for at, content in others:
            if at == k:
                chunk += record(Opcode.SCHEMA, content)
        entries.setdefault(channel, []).append((k, len(chunk)))
        payloads.setdefault(channel, []).append(data)
        chunk += record(Opcode.MESSAGE, struct.pack("<HIQQ", channel, k, k, k) + data)
    indices = [
        struct.pack("<HI", channel, 16 * len(rows)) + b"".join(struct.pack("<QQ", *r) for r in rows)
        for channel, rows in entries.items()
    ]
    return chunk, indices, payloads


def found(chunks, indices):
    joined, places, others = locate(chunks, indices)
    payloads = {
        channel: [joined[a : a + n] for a, n in zip(*map(np.ndarray.tolist, place), strict=True)]
        for channel, place in places.items()
    }
    return payloads, sorted(joined[start:stop] for _, start, stop in others)


@settings(max_examples=200, deadline=None)
@given(first=MESSAGES, second=MESSAGES, others=OTHERS)
def test_index_and_walk_find_the_same(first, second, others):
    parts = [chunk_of(first, others), chunk_of(second, [])]
    chunks, indices = [p[0] for p in parts], [p[1] for p in parts]
    quick, slow = found(chunks, indices), found(chunks, [[], []])
    assert quick == slow
    expected = dict(parts[0][2])
    for channel, payloads in parts[1][2].items():
        expected[channel] = expected.get(channel, []) + payloads
    assert slow[0] == expected


@settings(max_examples=200, deadline=None)
@given(messages=MESSAGES, at=st.integers(0, 10_000), mask=st.integers(1, 255), where=st.booleans())
def test_a_lying_index_changes_nothing(messages, at, mask, where):
    chunk, indices, payloads = chunk_of(messages, [])
    if not indices:
        return
    lying = [bytearray(record) for record in indices]
    target = lying[at % len(lying)] if where else lying[0]
    target[at % len(target)] ^= mask
    assert found([chunk], [[bytes(r) for r in lying]])[0] == payloads
    assert found([chunk], [indices[1:]])[0] == payloads


def test_a_record_may_not_run_into_the_next_chunk():
    torn = record(Opcode.MESSAGE, bytes(40))
    with pytest.raises(ValueError, match="past the end of its chunk"):
        locate([torn[:30], torn[30:]], [[struct.pack("<HIQQ", 0, 16, 0, 0)], []])


def test_frames_of_many_sizes_are_taken_as_one_by_one():
    payloads = [bytes([k] * (8 if k % 3 else k % 5)) for k in range(50)]
    messages = [pack_frame(k, 0x201, data) for k, data in enumerate(payloads)]
    frames, dropped = unpack_frames(messages)
    assert frames.dtype == FRAME
    assert [f["data"].tobytes() for f in frames] == [p for p in payloads if len(p) == 8]
    assert frames["stamp_ns"].tolist() == [k for k, p in enumerate(payloads) if len(p) == 8]
    assert dropped == sum(len(p) != 8 for p in payloads)


def test_a_log_decodes_as_cantools_says(tmp_path):
    path = record_on(FakeRobot(), tmp_path)
    trace, dbc = read_log(path), database()
    frames, _ = unpack_frames(read_content(path).messages["/can/raw"])
    for m, motor in enumerate(("left", "right")):
        said = [
            dbc.decode_message(f"FEEDBACK_{m + 1}", f["data"].tobytes())
            for f in frames
            if f["id"] == 0x201 + m
        ][: len(trace)]
        assert trace[f"{motor}.current"].tolist() == [float(s["current"]) for s in said]
        assert trace[f"{motor}.temperature"].tolist() == [float(s["temperature"]) for s in said]
    sent = [dbc.decode_message("COMMAND", f["data"].tobytes()) for f in frames if f["id"] == 0x200]
    assert trace["right.command"].tolist() == [float(s["current_2"]) for s in sent[1:]]


TURNS = 60


def test_four_threads_read_what_one_reads(tmp_path):
    path = record_on(FakeRobot(), tmp_path, duration=2.0)
    alone = read_content(path)
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda _: read_content(path), range(TURNS)))
    for content in found:
        assert content.attachments == alone.attachments
        assert content.messages.keys() == alone.messages.keys()
        for topic, messages in content.messages.items():
            assert np.array_equal(messages, alone.messages[topic])
