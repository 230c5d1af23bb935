"""The payloads of each topic, found in several chunks at once and taken out in bulk.

A chunk is followed by an index of its messages.  It is the quick way, and believed only where the
chunk's own bytes say the same: every place named is a message of that channel, and between them
and at both ends lie whole records that are none.  Otherwise the chunks are walked record by
record, which is the slow way and always right.
"""

import io
import itertools
import struct
from collections.abc import Collection, Iterator, Sequence

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel

RECORD = struct.Struct("<BQ")  # opcode, length of what follows
MOST_OTHERS = 100_000  # schemas and channels at once; more is a file made to fill the memory
MESSAGE_HEAD = 22  # channel, sequence, two stamps: before the payload
_MESSAGE = struct.Struct("<BQH")
_INDEX = struct.Struct("<HI")  # channel, bytes of the entries that follow
_ENTRY = np.dtype([("time", "<u8"), ("offset", "<u8")])
_HEAD = np.dtype([("opcode", "u1"), ("length", "<u8"), ("channel", "<u2")])

Places = dict[int, tuple[np.ndarray, np.ndarray]]  # channel -> payload starts, payload sizes
Others = list[tuple[int, int, int]]  # opcode, start and stop of records that are no messages
Located = tuple[bytes, Places, Others]


def locate(chunks: Sequence[bytes], indices: Sequence[Sequence[bytes]]) -> Located:
    """The chunks as one, payloads by channel in the order written, and all other records.

    indices  for each chunk the MessageIndex records that followed it, if any
    Raises ValueError where records do not fill a chunk.
    """
    joined = chunks[0] if len(chunks) == 1 else b"".join(chunks)
    bases = np.cumsum([0, *map(len, chunks)])
    found = _by_index(joined, bases, indices) or _by_walking(joined, bases.tolist())
    return joined, *found


def _by_index(
    chunk: bytes, bases: np.ndarray, indices: Sequence[Sequence[bytes]]
) -> tuple[Places, Others] | None:
    if len(chunk) < _HEAD.itemsize:
        return None
    offsets, claimed = _entries(bases, indices)
    if not len(offsets) or int(offsets.max()) > len(chunk) - _HEAD.itemsize:
        return None
    order = np.argsort(offsets, kind="stable")
    offsets, claimed = offsets[order].astype(np.int64), claimed[order]
    windows = np.lib.stride_tricks.sliding_window_view(
        np.frombuffer(chunk, np.uint8), _HEAD.itemsize
    )
    heads = windows[offsets].view(_HEAD)[:, 0]
    length = heads["length"]
    said = (heads["opcode"] == Opcode.MESSAGE) & (heads["channel"] == claimed)
    if not np.all(said & (length >= MESSAGE_HEAD) & (length <= len(chunk))):
        return None
    ends = offsets + RECORD.size + length.astype(np.int64)
    if np.any(ends[np.searchsorted(offsets, bases[1:-1]) - 1] != bases[1:-1]):
        return None  # a record may run from one chunk into the next
    others = _between(chunk, offsets, ends)
    if others is None:
        return None
    starts, sizes = offsets + RECORD.size + MESSAGE_HEAD, length.astype(np.int64) - MESSAGE_HEAD
    places: Places = {}
    for channel in np.flatnonzero(np.bincount(claimed)).tolist():
        mine = np.flatnonzero(claimed == channel)
        places[channel] = starts[mine], sizes[mine]
    return places, others


def _entries(
    bases: np.ndarray, indices: Sequence[Sequence[bytes]]
) -> tuple[np.ndarray, np.ndarray]:
    """Every offset that the indices name, from the start of all chunks, and its channel."""
    parts, starts, channels, counts = [], [], [], []
    for base, records_of_chunk in zip(bases.tolist(), indices, strict=False):
        for record in records_of_chunk:
            if len(record) < _INDEX.size:
                continue
            channel, size = _INDEX.unpack_from(record)
            if size == len(record) - _INDEX.size and size % _ENTRY.itemsize == 0:
                parts.append(record[_INDEX.size :])
                starts.append(base)
                channels.append(channel)
                counts.append(size // _ENTRY.itemsize)
    offsets = np.frombuffer(b"".join(parts), _ENTRY)["offset"]
    shifted = offsets + np.repeat(np.array(starts, np.uint64), counts)
    return shifted, np.repeat(np.array(channels, np.uint16), counts)


def _between(chunk: bytes, offsets: np.ndarray, ends: np.ndarray) -> Others | None:
    """The records before, between and after the messages; None where a message is among them."""
    begin = np.concatenate([[0], ends])
    stop = np.concatenate([offsets, [len(chunk)]])
    if np.any(begin > stop):
        return None
    others: Others = []
    for k in np.flatnonzero(begin < stop).tolist():
        for opcode, start, end in records(chunk, int(begin[k]), int(stop[k])):
            if opcode == Opcode.MESSAGE:
                return None
            _add(others, opcode, start, end)
    return others


def _add(others: Others, opcode: int, start: int, stop: int) -> None:
    if len(others) >= MOST_OTHERS:
        raise ValueError(f"more than {MOST_OTHERS} records of its chunks are no messages")
    others.append((opcode, start, stop))


def _by_walking(chunk: bytes, bases: Sequence[int]) -> tuple[Places, Others]:
    found: dict[int, list[tuple[int, int]]] = {}
    others: Others = []
    for begin, end in itertools.pairwise(bases):
        _walk_one(chunk, begin, end, found, others)
    arrays = {channel: np.array(places, np.int64) for channel, places in found.items()}
    return {channel: (a[:, 0], a[:, 1]) for channel, a in arrays.items()}, others


def _walk_one(
    chunk: bytes, at: int, end: int, found: dict[int, list[tuple[int, int]]], others: Others
) -> None:
    unpack = _MESSAGE.unpack_from
    while at < end:
        if end - at < _MESSAGE.size:
            others += records(chunk, at, end)
            return
        opcode, length, channel = unpack(chunk, at)
        start, at = at + RECORD.size, at + RECORD.size + length
        if at > end:
            raise ValueError("a record runs past the end of its chunk")
        if opcode != Opcode.MESSAGE:
            _add(others, opcode, start, at)
            continue
        if length < MESSAGE_HEAD:
            raise ValueError("a message is shorter than its own head")
        found.setdefault(channel, []).append((start + MESSAGE_HEAD, length - MESSAGE_HEAD))


def records(content: bytes, at: int, end: int) -> Iterator[tuple[int, int, int]]:
    """Opcode, start and stop of each record that fills [at, end); ValueError where they do not."""
    while at < end:
        if end - at < RECORD.size:
            raise ValueError("a chunk ends inside the head of a record")
        opcode, length = RECORD.unpack_from(content, at)
        start, at = at + RECORD.size, at + RECORD.size + length
        if at > end:
            raise ValueError("a record runs past the end of its chunk")
        yield opcode, start, at


CHUNK_LIMIT = 64 * 2**20  # a log of ours has 64 KiB chunks; a gigabyte in one is a broken length
KEPT_LIMIT = 256 * 2**20  # payloads that are wanted: what a reader may hold in memory
EXPANSION_LIMIT = 50  # a log of ours unpacks to twice its size, one at rest to twenty times
GROUP_BYTES = 2**20  # chunks that are taken apart at once
Payloads = np.ndarray | list[bytes]


def unpacking_limit(file_size: int) -> int:
    """Bytes that all chunks of a file may unpack to; more is a bomb, not a log."""
    return max(CHUNK_LIMIT, EXPANSION_LIMIT * file_size)


class MessagesByTopic:
    """The payloads of each channel; chunks are let go once these are taken."""

    def __init__(self, file_size: int, topics: Collection[str] | None) -> None:
        self._limit = unpacking_limit(file_size)
        self._wanted = topics
        self._topics: dict[int, str] = {}
        self._payloads: dict[int, list[Payloads]] = {}
        self._length = self._pending = self._kept = 0
        self._chunks: list[bytes] = []
        self._indices: list[list[bytes]] = []

    def chunk(self, content: bytes) -> None:
        """Take in a chunk; that which follows before the next chunk belongs to it."""
        self._length += len(content)
        if self._length > self._limit:
            raise ValueError(f"it unpacks to more than {self._limit} bytes")
        if self._pending > GROUP_BYTES:
            self.settle()
        self._pending += len(content)
        self._chunks.append(content)
        self._indices.append([])

    def index(self, record: bytes) -> None:
        """Take in a message index of the latest chunk."""
        if self._indices:
            self._indices[-1].append(record)

    def settle(self) -> None:
        """Keep the payloads that are wanted of the chunks so far, and let the chunks go."""
        if not self._chunks:
            return
        chunk, places, others = locate(self._chunks, self._indices)
        self._chunks, self._indices, self._pending = [], [], 0
        for opcode, start, stop in others:
            if opcode == Opcode.CHANNEL:
                self.register(chunk[start:stop])
        for channel, (starts, sizes) in places.items():
            if self._wanted is None or self._topics.get(channel, "") in (*self._wanted, ""):
                self._kept += int(sizes.sum())
                if self._kept > KEPT_LIMIT:
                    raise ValueError(f"its messages hold more than {KEPT_LIMIT >> 20} MiB")
                self._payloads.setdefault(channel, []).append(_gather(chunk, starts, sizes))

    def register(self, record: bytes) -> None:
        channel = Channel.read(stream(record))
        self._topics[channel.id] = channel.topic

    def by_topic(self) -> dict[str, Payloads]:
        return {
            self._topics.get(channel, f"channel {channel}"): _joined(parts)
            for channel, parts in self._payloads.items()
        }


def _gather(chunk: bytes, starts: np.ndarray, sizes: np.ndarray) -> Payloads:
    size = int(sizes[0])
    if size > 0 and np.all(sizes == size):
        everything = np.frombuffer(chunk, np.uint8)
        return np.lib.stride_tricks.sliding_window_view(everything, size)[starts]
    ends = (starts + sizes).tolist()
    return [chunk[start:end] for start, end in zip(starts.tolist(), ends, strict=True)]


def _joined(parts: list[Payloads]) -> Payloads:
    arrays = [part for part in parts if isinstance(part, np.ndarray)]
    if len(arrays) == len(parts) and len({a.shape[1] for a in arrays}) == 1:
        return np.concatenate(arrays)
    return [bytes(message) for part in parts for message in part]


def stream(record: bytes) -> ReadDataStream:
    """A record's content as mcap's parsers take it."""
    return ReadDataStream(io.BytesIO(record))
