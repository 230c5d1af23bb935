"""Whatever happens to a log, all that is whole in it comes back."""

import io
import random
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.records import Attachment, Chunk, Metadata
from mcap.stream_reader import StreamReader, breakup_chunk

from spirob.cli.main import main
from spirob.errors import DataError, SpirobError
from spirob.logs import read_log
from spirob.logs.recovery import recover
from tests.trials.fake_robot import FakeRobot
from tests.trials.trials import record_on

CUTS = 200


class Known:
    """What mcap's own reader finds in a whole log, and at which byte each record ends."""

    def __init__(self, path):
        self.raw = path.read_bytes()
        self.chunks, self.others = [], []
        file = io.BytesIO(self.raw)
        for record in StreamReader(file, emit_chunks=True).records:
            stop = file.tell()
            if isinstance(record, Chunk):
                messages = [m for m in breakup_chunk(record) if type(m).__name__ == "Message"]
                start = stop - len(record.data) - 53  # head of the record before its data
                self.chunks.append((start, stop, messages))
            elif isinstance(record, Metadata | Attachment):
                self.others.append((stop, record))

    def before(self, cut):
        messages = [m for _, stop, found in self.chunks if stop <= cut for m in found]
        return messages, [record.name for stop, record in self.others if stop <= cut]


def content(path):
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        messages = [m for _, _, m in reader.iter_messages(log_time_order=False)]
        names = [m.name for m in reader.iter_metadata()]
        return messages, names + [a.name for a in reader.iter_attachments()]


def plain(messages):
    return [(m.channel_id, m.sequence, m.log_time, m.publish_time, m.data) for m in messages]


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    return record_on(FakeRobot(), tmp_path_factory.mktemp("log"), 0.8)


@pytest.fixture(scope="module")
def known(log):
    found = Known(log)
    assert len(found.chunks) >= 4
    return found


def again(tmp_path, raw, number=0):
    torn, back = tmp_path / f"{number}.mcap", tmp_path / f"{number}.back.mcap"
    torn.write_bytes(raw)
    return recover(torn, back), back


def test_a_log_cut_at_any_byte_gives_back_every_whole_chunk(known, tmp_path):
    places = random.Random(6)
    for number in range(CUTS):
        cut = places.randrange(len(known.raw))
        expected, names = known.before(cut)
        if not expected and not names:
            with pytest.raises(DataError, match=r"whole|not an MCAP"):
                again(tmp_path, known.raw[:cut], number)
            continue
        done, back = again(tmp_path, known.raw[:cut], number)
        messages, found = content(back)
        assert plain(messages) == plain(expected)
        assert found == names
        assert done.messages == len(expected)
        assert any("without a footer" in note for note in done.notes)


def test_flipped_bytes_cost_the_chunks_they_lie_in_and_no_other(known, tmp_path):
    places = random.Random(7)
    first = known.chunks[0][0]
    for number in range(60):
        raw = bytearray(known.raw)
        hit = sorted(places.randrange(first, known.chunks[-1][1]) for _ in range(2))
        for at in hit:
            raw[at] ^= places.randrange(1, 256)
        lost = [any(start <= at < stop for at in hit) for start, stop, _ in known.chunks]
        messages, _ = content(again(tmp_path, bytes(raw), number)[1])
        kept = [
            m for (_, _, of), gone in zip(known.chunks, lost, strict=True) if not gone for m in of
        ]
        # a flip in a part that no checksum guards, such as the chunk's first time, costs nothing
        missing = Counter(plain(kept)) - Counter(plain(messages))
        assert not missing
        everything = plain([m for _, _, of in known.chunks for m in of])
        assert not Counter(plain(messages)) - Counter(everything)


def test_without_its_first_chunk_a_log_of_ours_still_reads(known, tmp_path, log):
    _, stop, lost = known.chunks[0]
    raw = bytearray(known.raw)[: known.chunks[-1][1]]  # no summary that repeats the channels
    raw[stop - 20] ^= 1
    done, back = again(tmp_path, bytes(raw))
    assert any("writer's own list" in note for note in done.notes)
    trace, whole = read_log(back), read_log(log)
    row = len(whole) - len(trace)
    assert 0 < row <= len(lost)
    np.testing.assert_array_equal(trace["left.command"][1:], whole["left.command"][row + 1 :])
    np.testing.assert_array_equal(trace["left.velocity"][1:], whole["left.velocity"][row + 1 :])


def test_a_damaged_attachment_is_named_and_the_rest_kept(known, tmp_path):
    at = known.raw.index(b"there_and_back", known.raw.index(b"trial.yaml"))
    raw = bytearray(known.raw)
    raw[at] ^= 1
    done, back = again(tmp_path, bytes(raw))
    assert any("'trial.yaml' fails its checksum" in note for note in done.notes)
    assert content(back)[1] == ["spirob", "config.yaml"]


def test_an_undamaged_log_comes_back_to_the_byte(log, tmp_path):
    done = recover(log, tmp_path / "same.mcap")
    assert (tmp_path / "same.mcap").read_bytes() == log.read_bytes()
    assert done.notes == []


@settings(max_examples=200, deadline=None)
@given(
    raw=st.binary(max_size=200),
    flips=st.lists(st.tuples(st.floats(0, 1, exclude_max=True), st.integers(1, 255)), max_size=6),
)
def test_hostile_files_are_refused_or_recovered_but_never_crash(
    known, tmp_path_factory, raw, flips
):
    folder = tmp_path_factory.mktemp("hostile")
    damaged = bytearray(known.raw[:3000] + raw + known.raw[3000:60000])
    for at, mask in flips:
        damaged[int(at * len(damaged))] ^= mask
    for content in (b"\x89MCAP0\r\n" + raw, bytes(damaged)):
        try:
            _, back = again(folder, content, len(content))
        except SpirobError as error:
            assert "\n" not in str(error)
        else:
            back.unlink()


def test_the_command_says_what_came_back(known, tmp_path, capsys):
    (tmp_path / "torn.mcap.part").write_bytes(known.raw[: known.chunks[2][1] + 100])
    asked = ["recover", str(tmp_path / "torn.mcap.part"), "--out", str(tmp_path / "back.mcap")]
    assert main(asked) == 0
    said = capsys.readouterr()
    assert "of 3 chunks, 2 attachments, 1 metadata" in said.out
    assert "without a footer" in said.err
    assert main(asked) == 2
    assert "exists already" in capsys.readouterr().err
    assert main(["recover", str(tmp_path / "nowhere"), "--out", str(tmp_path / "b")]) == 2
