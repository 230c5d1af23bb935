"""However a log is damaged: either it reads as before or it is refused in a sentence."""

import contextlib
import struct

import numpy as np
import pytest
import zstandard
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.errors import DataError, SpirobError
from spirob.logs import read_log
from spirob.logs.reader import MAGIC
from tests.trials.fake_robot import FakeRobot
from tests.trials.trials import record_on

DAMAGE = settings(max_examples=150, deadline=None)


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    return record_on(FakeRobot(), tmp_path_factory.mktemp("log"), 0.3)


@pytest.fixture(scope="module")
def whole(log):
    return read_log(log)


@pytest.fixture(scope="module")
def damaged(log):
    path = log.with_name("damaged.mcap")
    whole = log.read_bytes()

    def write(change):
        path.write_bytes(change(bytearray(whole)))
        return path

    return write


@DAMAGE
@given(at=st.floats(0, 1, exclude_max=True))
def test_a_truncated_log_is_refused_by_name(damaged, at):
    path = damaged(lambda b: b[: int(at * len(b))])
    with pytest.raises(DataError, match=r"damaged\.mcap"):
        read_log(path)


@DAMAGE
@given(at=st.floats(0, 1, exclude_max=True))
def test_what_a_torn_log_still_holds_can_be_asked_for(damaged, at):
    path = damaged(lambda b: b[: int(at * len(b))])
    try:
        trace = read_log(path, torn=True)
    except SpirobError as error:
        assert "damaged.mcap" in str(error)
    else:
        assert 100 <= len(trace) <= 300
        assert trace.meta["torn"]


@DAMAGE
@given(
    flips=st.lists(
        st.tuples(st.floats(0, 1, exclude_max=True), st.integers(1, 255)), min_size=1, max_size=4
    )
)
def test_flipped_bytes_never_crash_the_reader_nor_pass_as_data(damaged, whole, flips):
    def flip(content):
        for at, mask in flips:
            content[int(at * len(content))] ^= mask
        return content

    for torn in (False, True):
        try:
            trace = read_log(damaged(flip), torn=torn)
        except SpirobError as error:
            assert "damaged.mcap" in str(error)
            assert "\n" not in str(error)
        else:
            assert torn or all(np.array_equal(trace[c], whole[c]) for c in whole.signals)


@DAMAGE
@given(junk=st.binary(max_size=300))
def test_junk_after_the_magic_never_crashes_the_reader(damaged, junk):
    with pytest.raises(DataError, match=r"damaged\.mcap"):
        read_log(damaged(lambda _: MAGIC + junk))


def test_an_absurd_record_length_is_refused(damaged):
    record = MAGIC + struct.pack("<BQ", 6, 2**62) + bytes(100)
    with pytest.raises(DataError, match="torn"):
        read_log(damaged(lambda _: record))


def test_an_absurd_chunk_size_is_refused(damaged):
    bomb = zstandard.compress(bytes(200 * 2**20))
    chunk = struct.pack("<QQQI", 0, 0, 200 * 2**20, 0) + struct.pack("<I4s", 4, b"zstd")
    chunk += struct.pack("<Q", len(bomb)) + bomb
    with pytest.raises(DataError, match="claims"):
        read_log(damaged(lambda _: MAGIC + struct.pack("<BQ", 6, len(chunk)) + chunk))


@given(messages=st.lists(st.binary(max_size=40), min_size=1, max_size=5))
def test_garbage_messages_are_data_errors(messages):
    from spirob.logs.messages import unpack_commands, unpack_frames

    for unpack in (unpack_frames, unpack_commands):
        with contextlib.suppress(DataError):
            unpack(messages)
