"""The payloads of each topic, taken out of chunks in bulk; bounded in memory."""

import io
from collections.abc import Collection

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel

from spirob.logs.locating import locate

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
