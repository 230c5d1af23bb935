"""The records of an MCAP file, messages in bulk; trusts no length and no checksum unseen."""

import os
import struct
import threading
import zlib
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import zstandard
from lz4.frame import LZ4FrameDecompressor
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Chunk, DataEnd, Metadata

from spirob.errors import DataError, MissingLog
from spirob.logs.payloads import CHUNK_LIMIT, RECORD, MessagesByTopic, Payloads, stream

MAGIC = b"\x89MCAP0\r\n"
FILE_LIMIT = 256 * 2**20  # about 24 minutes of both motors at 1 kHz
_OWN = threading.local()  # each thread's decompressor: one shared by two spoils the data of both
BROKEN = (
    McapError,
    struct.error,
    ValueError,
    OverflowError,
    zstandard.ZstdError,
    RuntimeError,  # of lz4
)


@dataclass
class Content:
    """What a log file holds.

    metadata, attachments  by name
    messages  topic -> payloads in the order written: (n, size) uint8 where all have one size
    torn      the file breaks off; what stands here is complete up to there
    """

    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    messages: dict[str, Payloads] = field(default_factory=dict)
    torn: bool = False


def read_content(
    path: Path | str, torn: bool = False, topics: Collection[str] | None = None
) -> Content:
    """Read a whole MCAP file; with `torn`, accept one that breaks off.

    topics  those whose messages are wanted; None means all
    Raises MissingLog, and DataError where the file is torn, corrupt or no MCAP.
    """
    raw = read_bytes(path)
    content, messages = Content(), MessagesByTopic(len(raw), topics)
    try:
        try:
            for opcode, start, stop in _walk(raw):
                _take(raw, opcode, start, stop, content, messages)
        except EOFError:
            content.torn = True
        messages.settle()
    except BROKEN as error:
        raise DataError(f"{path}: the log is corrupt: {error or type(error).__name__}") from error
    if content.torn and not torn:
        raise DataError(f"{path}: the log is torn, it ends without a footer")
    content.messages = messages.by_topic()
    return content


def read_bytes(path: Path | str) -> bytes:
    """A whole MCAP file; raises MissingLog, and DataError where it is none or far too large."""
    try:
        with open(path, "rb") as file:
            size = os.fstat(file.fileno()).st_size
            raw = file.read(min(size, FILE_LIMIT))
    except FileNotFoundError:
        raise MissingLog(f"{path}: there is no such log") from None
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from error
    if not raw.startswith(MAGIC):
        raise DataError(f"{path}: this is not an MCAP file")
    if size > FILE_LIMIT:
        raise DataError(f"{path}: more than {FILE_LIMIT >> 20} MiB; record shorter trials")
    return raw


def _walk(raw: bytes) -> Iterator[tuple[int, int, int]]:
    """Opcode, start and stop of each record; EOFError where the file breaks off."""
    at, end = len(MAGIC), len(raw)
    while at + RECORD.size <= end:
        opcode, length = RECORD.unpack_from(raw, at)
        start, at = at + RECORD.size, at + RECORD.size + length
        if at > end:
            raise EOFError
        yield opcode, start, at
        if opcode == Opcode.FOOTER:
            if raw[at:] != MAGIC:
                raise EOFError
            return
    raise EOFError


def _take(
    raw: bytes, opcode: int, start: int, stop: int, content: Content, messages: MessagesByTopic
) -> None:
    record = raw[start:stop]
    if opcode == Opcode.CHUNK:
        messages.chunk(unpack_chunk(Chunk.read(stream(record))))
    elif opcode == Opcode.MESSAGE_INDEX:
        messages.index(record)
    elif opcode == Opcode.CHANNEL:
        messages.register(record)
    elif opcode == Opcode.METADATA:
        metadata = Metadata.read(stream(record))
        content.metadata[metadata.name] = metadata.metadata
    elif opcode == Opcode.ATTACHMENT:
        attachment = Attachment.read(stream(record))
        if zlib.crc32(record[:-4]) != int.from_bytes(record[-4:], "little"):
            raise ValueError(f"attachment '{attachment.name}' fails its checksum")
        content.attachments[attachment.name] = attachment.data
    elif opcode == Opcode.DATA_END:
        expected = DataEnd.read(stream(record)).data_section_crc
        if expected and zlib.crc32(memoryview(raw)[: start - RECORD.size]) != expected:
            raise ValueError("the data section fails its checksum")


def unpack_chunk(chunk: Chunk) -> bytes:
    """What a chunk holds; ValueError where its size, compression or checksum is wrong."""
    size, data = chunk.uncompressed_size, chunk.data
    if chunk.compression not in ("", "zstd", "lz4"):
        raise ValueError(f"compression '{chunk.compression}' is not supported, only zstd and lz4")
    if chunk.compression == "lz4":
        if size > CHUNK_LIMIT:
            raise ValueError(f"a chunk claims {size} bytes, more than {CHUNK_LIMIT}")
        data = LZ4FrameDecompressor().decompress(data, max_length=size + 1)
    elif chunk.compression:
        claimed = zstandard.frame_content_size(data)
        if max(size, claimed) > CHUNK_LIMIT:
            raise ValueError(f"a chunk claims {max(size, claimed)} bytes, more than {CHUNK_LIMIT}")
        data = _decompressor().decompress(data, max_output_size=size)
    if len(data) != size or (chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc):
        raise ValueError("a chunk fails its checksum")
    return data


def _decompressor() -> zstandard.ZstdDecompressor:
    """The thread's own; making one takes longer than a chunk does."""
    if not hasattr(_OWN, "made"):
        _OWN.made = zstandard.ZstdDecompressor()
    made: zstandard.ZstdDecompressor = _OWN.made
    return made
