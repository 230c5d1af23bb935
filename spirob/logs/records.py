"""The records of an MCAP file, messages in bulk; trusts no length and no checksum unseen."""

import io
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, DataEnd, Metadata

from spirob.errors import DataError, MissingLog

MAGIC = b"\x89MCAP0\r\n"
CHUNK_LIMIT = 64 * 2**20  # a log of ours has 64 KiB chunks; a gigabyte in one is a broken length
TOTAL_LIMIT = 4 * 2**30
_RECORD = struct.Struct("<BQ")
_MESSAGE = struct.Struct("<BQH")
_MESSAGE_HEAD = 22  # channel, sequence, two stamps: before the payload
_BROKEN = (McapError, struct.error, ValueError, OverflowError, zstandard.ZstdError)


@dataclass
class Content:
    """What a log file holds.

    metadata, attachments  by name
    messages  topic -> payloads in the order written: (n, size) uint8 where all have one size
    torn      the file breaks off; what stands here is complete up to there
    """

    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    messages: dict[str, np.ndarray | list[bytes]] = field(default_factory=dict)
    torn: bool = False


def read_content(path: Path | str, torn: bool = False) -> Content:
    """Read a whole MCAP file; with `torn`, accept one that breaks off.

    Raises MissingLog, and DataError where the file is torn, corrupt or no MCAP.
    """
    try:
        raw = Path(path).read_bytes()
    except FileNotFoundError:
        raise MissingLog(f"{path}: there is no such log") from None
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from error
    if not raw.startswith(MAGIC):
        raise DataError(f"{path}: this is not an MCAP file")
    content, messages = Content(), _Messages()
    try:
        try:
            for opcode, start, stop in _walk(raw):
                _take(raw, opcode, start, stop, content, messages)
        except EOFError:
            content.torn = True
    except _BROKEN as error:
        raise DataError(f"{path}: the log is corrupt: {error or type(error).__name__}") from error
    if content.torn and not torn:
        raise DataError(f"{path}: the log is torn, it ends without a footer")
    content.messages = messages.by_topic()
    return content


class _Messages:
    """Chunks one after the other, and where in them the messages of each channel lie."""

    def __init__(self) -> None:
        self.topics: dict[int, str] = {}
        self.chunks: list[bytes] = []
        self.length = 0
        self.places: dict[int, list[tuple[int, int]]] = {}

    def add(self, chunk: bytes) -> None:
        at, end, base, unpack = 0, len(chunk), self.length, _MESSAGE.unpack_from
        while at < end:
            opcode, length, channel = unpack(chunk, at)
            start, at = at + _RECORD.size, at + _RECORD.size + length
            if at > end:
                raise ValueError("a record runs past the end of its chunk")
            if opcode == Opcode.MESSAGE:
                if length < _MESSAGE_HEAD:
                    raise ValueError("a message is shorter than its own head")
                place = (base + start + _MESSAGE_HEAD, length - _MESSAGE_HEAD)
                self.places.setdefault(channel, []).append(place)
            elif opcode == Opcode.CHANNEL:
                self.register(chunk[start:at])
        self.chunks.append(chunk)
        self.length += end

    def register(self, record: bytes) -> None:
        channel = Channel.read(_stream(record))
        self.topics[channel.id] = channel.topic

    def by_topic(self) -> dict[str, np.ndarray | list[bytes]]:
        everything = b"".join(self.chunks)
        found: dict[str, np.ndarray | list[bytes]] = {}
        for channel, places in self.places.items():
            topic = self.topics.get(channel, f"channel {channel}")
            starts, sizes = np.array(places, np.int64).T
            if sizes[0] > 0 and np.all(sizes == sizes[0]):
                windows = np.lib.stride_tricks.sliding_window_view(
                    np.frombuffer(everything, np.uint8), int(sizes[0])
                )
                found[topic] = windows[starts]
            else:
                found[topic] = [everything[a : a + size] for a, size in places]
        return found


def _walk(raw: bytes) -> Iterator[tuple[int, int, int]]:
    """Opcode, start and stop of each record; EOFError where the file breaks off."""
    at, end = len(MAGIC), len(raw)
    while at + _RECORD.size <= end:
        opcode, length = _RECORD.unpack_from(raw, at)
        start, at = at + _RECORD.size, at + _RECORD.size + length
        if at > end:
            raise EOFError
        yield opcode, start, at
        if opcode == Opcode.FOOTER:
            if raw[at:] != MAGIC:
                raise EOFError
            return
    raise EOFError


def _take(
    raw: bytes, opcode: int, start: int, stop: int, content: Content, messages: _Messages
) -> None:
    record = raw[start:stop]
    if opcode == Opcode.CHUNK:
        if messages.length > TOTAL_LIMIT:
            raise ValueError(f"it holds more than {TOTAL_LIMIT} bytes")
        messages.add(_unpack(Chunk.read(_stream(record))))
    elif opcode == Opcode.CHANNEL:
        messages.register(record)
    elif opcode == Opcode.METADATA:
        metadata = Metadata.read(_stream(record))
        content.metadata[metadata.name] = metadata.metadata
    elif opcode == Opcode.ATTACHMENT:
        attachment = Attachment.read(_stream(record))
        if zlib.crc32(record[:-4]) != int.from_bytes(record[-4:], "little"):
            raise ValueError(f"attachment '{attachment.name}' fails its checksum")
        content.attachments[attachment.name] = attachment.data
    elif opcode == Opcode.DATA_END:
        expected = DataEnd.read(_stream(record)).data_section_crc
        if expected and zlib.crc32(memoryview(raw)[: start - _RECORD.size]) != expected:
            raise ValueError("the data section fails its checksum")


def _unpack(chunk: Chunk) -> bytes:
    size, data = chunk.uncompressed_size, chunk.data
    if chunk.compression not in ("", "zstd"):
        raise ValueError(f"compression '{chunk.compression}' is not supported, only zstd and none")
    if chunk.compression:
        claimed = zstandard.frame_content_size(data)
        if max(size, claimed) > CHUNK_LIMIT:
            raise ValueError(f"a chunk claims {max(size, claimed)} bytes, more than {CHUNK_LIMIT}")
        data = zstandard.decompress(data, max_output_size=size)
    if len(data) != size or (chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc):
        raise ValueError("a chunk fails its checksum")
    return data


def _stream(record: bytes) -> ReadDataStream:
    return ReadDataStream(io.BytesIO(record))
