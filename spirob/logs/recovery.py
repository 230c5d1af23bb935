"""Brings back what a torn or damaged MCAP file still holds, as a whole file.

Every chunk whose checksum holds comes back with all its messages, every attachment whose checksum
holds, and all metadata; a chunk that was cut or changed is left out, and said so.

Records stand one after the other, so one wrong length hides all that follow.  A record is
therefore believed only where its own parts fill it exactly; otherwise the next place is searched
at which a chunk, an attachment, metadata, a schema or a channel does.
"""

import re
import struct
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, DataEnd, Header, Metadata, Schema
from mcap.writer import CompressionType, Writer

from spirob.errors import DataError
from spirob.files import replacing
from spirob.logs.messages import SCHEMAS
from spirob.logs.payloads import MESSAGE_HEAD, RECORD, records, stream, unpacking_limit
from spirob.logs.reader import BROKEN, MAGIC, read_bytes, unpack_chunk
from spirob.logs.writer import CHUNK_BYTES

_SEARCHED = bytes([Opcode.SCHEMA, Opcode.CHANNEL, Opcode.CHUNK, Opcode.ATTACHMENT, Opcode.METADATA])
_CANDIDATE = re.compile(b"(?=[" + re.escape(_SEARCHED) + rb"][\x00-\xff]{4}\x00{4})")
_FIXED = {Opcode.FOOTER: 20, Opcode.DATA_END: 4}
_KNOWN = range(Opcode.HEADER, Opcode.DATA_END + 1)


@dataclass(frozen=True)
class Place:
    """A record whose parts fill it: what it is and where its content lies."""

    opcode: int
    start: int
    stop: int


@dataclass(frozen=True)
class Gap:
    """Bytes that no record could be made of."""

    start: int
    stop: int


def whole_records(raw: bytes, at: int) -> Iterator[Place | Gap]:
    """Every record from `at` on that fills itself, and what lies between them."""
    while at < len(raw):
        place = _record_at(raw, at)
        if place is None:
            found = _next(raw, at + 1)
            yield Gap(at, found)
            at = found
            continue
        yield place
        at = place.stop
        if place.opcode == Opcode.FOOTER:
            return


def _next(raw: bytes, at: int) -> int:
    for match in _CANDIDATE.finditer(raw, at):
        if _record_at(raw, match.start()) is not None:
            return match.start()
    return len(raw)


def _record_at(raw: bytes, at: int) -> Place | None:
    if at + RECORD.size > len(raw):
        return None
    opcode, length = RECORD.unpack_from(raw, at)
    start = at + RECORD.size
    if opcode not in _KNOWN or length > len(raw) - start:
        return None
    try:
        fills = _fills(raw, opcode, start, start + length)
    except (struct.error, UnicodeDecodeError, ValueError):
        return None
    return Place(opcode, start, start + length) if fills else None


def _fills(raw: bytes, opcode: int, start: int, stop: int) -> bool:
    if opcode in _FIXED:
        return stop - start == _FIXED[Opcode(opcode)]
    if opcode == Opcode.MESSAGE:
        return stop - start >= MESSAGE_HEAD
    if opcode == Opcode.CHUNK:  # two times, size, checksum, compression, records
        at = _text(raw, start + 28, stop)[1]
        return stop - at >= 8 and at + 8 + struct.unpack_from("<Q", raw, at)[0] == stop
    if opcode == Opcode.MESSAGE_INDEX:
        return stop - start >= 6 and start + 6 + struct.unpack_from("<I", raw, start + 2)[0] == stop
    if opcode == Opcode.METADATA:
        name, at = _text(raw, start, stop)
        return bool(name) and at + 4 + struct.unpack_from("<I", raw, at)[0] == stop
    if opcode == Opcode.ATTACHMENT:  # two times, name, media type, data, checksum
        name, at = _text(raw, start + 16, stop)
        at = _text(raw, at, stop)[1]
        return bool(name) and at + 8 + struct.unpack_from("<Q", raw, at)[0] + 4 == stop
    if opcode == Opcode.SCHEMA:  # id, name, encoding, data
        name, at = _text(raw, start + 2, stop)
        at = _text(raw, at, stop)[1]
        return bool(name) and at + 4 + struct.unpack_from("<I", raw, at)[0] == stop
    if opcode == Opcode.CHANNEL:  # id, schema, topic, encoding, metadata
        topic, at = _text(raw, start + 4, stop)
        at = _text(raw, at, stop)[1]
        return bool(topic) and at + 4 + struct.unpack_from("<I", raw, at)[0] == stop
    return True  # header and summary: nothing in them is needed to bring data back


def _text(raw: bytes, at: int, stop: int) -> tuple[str, int]:
    (size,) = struct.unpack_from("<I", raw, at)
    if at + 4 + size > stop:
        raise ValueError("text runs past the end of its record")
    return raw[at + 4 : at + 4 + size].decode(), at + 4 + size


_HEAD = struct.Struct("<HIQQ")  # channel, sequence, log time, publish time


@dataclass
class Recovered:
    """What came back, and a sentence for all that did not or cannot be vouched for."""

    chunks: int = 0
    messages: int = 0
    metadata: int = 0
    attachments: int = 0
    notes: list[str] = field(default_factory=list)


class Survey:
    """All that is whole in a file, in the order in which it stands there."""

    def __init__(self, raw: Any) -> None:  # bytes, or a file mapped to memory
        self.library, self.profile = "", ""
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}
        self.metadata: list[Metadata] = []
        self.attachments: list[Attachment] = []
        self.places: list[Place] = []  # of whole chunks, and of messages outside of any
        self.report = Recovered()
        self._raw = raw
        self._budget = unpacking_limit(len(raw))
        self._damaged = False
        last = 0
        for record in whole_records(raw, len(MAGIC)):
            if isinstance(record, Gap):
                self.note(f"{record.stop - record.start} bytes at {record.start} are no record")
            else:
                last = record.opcode
                self._take(record)
        if last != Opcode.FOOTER:
            self.note("the file breaks off without a footer")
        if self._damaged and self.metadata:
            self.report.notes.append("metadata carry no checksum and are taken as they stand")

    def note(self, sentence: str) -> None:
        """Say that something is lost or cannot be vouched for."""
        self._damaged = True
        self.report.notes.append(sentence)

    def _take(self, place: Place) -> None:
        content = self._raw[place.start : place.stop]
        try:
            self._take_whole(place, content)
        except BROKEN as error:
            kind = Opcode(place.opcode).name.lower()
            why = str(error) or type(error).__name__
            self.note(f"the {kind} at {place.start} is lost: {why}")

    def _take_whole(self, place: Place, content: bytes) -> None:
        if place.opcode == Opcode.CHUNK:
            self._chunk(Chunk.read(stream(content)))
            self.places.append(place)
        elif place.opcode == Opcode.HEADER:
            header = Header.read(stream(content))
            self.library, self.profile = header.library, header.profile
        elif place.opcode == Opcode.METADATA:
            self.metadata.append(Metadata.read(stream(content)))
        elif place.opcode == Opcode.ATTACHMENT:
            attachment = Attachment.read(stream(content))
            if zlib.crc32(content[:-4]) != int.from_bytes(content[-4:], "little"):
                raise ValueError(f"'{attachment.name}' fails its checksum")
            self.attachments.append(attachment)
        elif place.opcode == Opcode.DATA_END:
            expected = DataEnd.read(stream(content)).data_section_crc
            before = memoryview(self._raw)[: place.start - RECORD.size]
            if expected and zlib.crc32(before) != expected:
                self.note("the data section fails its checksum")
        elif place.opcode == Opcode.MESSAGE:
            self.places.append(place)
        else:
            self._declaration(place.opcode, content)

    def _chunk(self, record: Chunk) -> None:
        self._budget -= record.uncompressed_size
        if self._budget < 0:
            raise ValueError("all chunks together unpack to far more than the file's size")
        content = unpack_chunk(record)
        for opcode, start, stop in records(content, 0, len(content)):
            if opcode == Opcode.MESSAGE and stop - start < MESSAGE_HEAD:
                raise ValueError("a message is shorter than its own head")
        for opcode, start, stop in records(content, 0, len(content)):
            if opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                self._declaration(opcode, content[start:stop])
        self.report.chunks += 1

    def _declaration(self, opcode: int, content: bytes) -> None:
        if opcode == Opcode.SCHEMA:
            schema = Schema.read(stream(content))
            self.schemas.setdefault(schema.id, schema)
        elif opcode == Opcode.CHANNEL:
            channel = Channel.read(stream(content))
            self.channels.setdefault(channel.id, channel)

    def messages(self) -> Iterator[tuple[int, int, int, int, bytes]]:
        """Channel, sequence, log time, publish time and payload of each message."""
        for place in self.places:
            inside: Iterable[tuple[int, int, int]]
            if place.opcode == Opcode.MESSAGE:
                content, inside = self._raw, [(place.opcode, place.start, place.stop)]
            else:
                content = unpack_chunk(Chunk.read(stream(self._raw[place.start : place.stop])))
                inside = records(content, 0, len(content))
            for opcode, start, stop in inside:
                if opcode == Opcode.MESSAGE:
                    yield *_HEAD.unpack_from(content, start), content[start + MESSAGE_HEAD : stop]


def recover(source: Path | str, target: Path | str) -> Recovered:
    """Write what `source` still holds to `target`, whole or not at all.

    Raises MissingLog; DataError where there is no MCAP file, nothing whole is left in it, or
    `target` exists.
    """
    if Path(target).exists():
        raise DataError(f"{target}: exists already and is left as it is")
    found = Survey(read_bytes(source))
    if not (found.places or found.attachments or found.metadata):
        raise DataError(f"{source}: no chunk, attachment or metadata in it is whole")
    with replacing(target) as temporary, temporary.open("wb") as file:
        done = _write(found, file)
    return done


def _write(found: Survey, file: BinaryIO) -> Recovered:
    writer = Writer(
        file,
        chunk_size=CHUNK_BYTES,
        compression=CompressionType.ZSTD,
        enable_data_crcs=True,
    )
    writer.start(found.profile, found.library)
    for one in found.metadata:
        writer.add_metadata(one.name, one.metadata)
    for a in found.attachments:
        writer.add_attachment(a.create_time, a.log_time, a.name, a.media_type, a.data)
    _declare_lost(found)
    numbers = dict(_register(found, writer))
    report, unknown = found.report, 0
    for channel, sequence, logged, published, data in found.messages():
        if channel in numbers:
            writer.add_message(numbers[channel], logged, data, published, sequence)
            report.messages += 1
        else:
            unknown += 1
    writer.finish()
    if unknown:
        found.note(f"{unknown} messages are lost: their channels are declared nowhere")
    report.metadata, report.attachments = len(found.metadata), len(found.attachments)
    return report


def _declare_lost(found: Survey) -> None:
    """The channels of a log of ours whose first chunk, which declares them, is gone."""
    if not found.library.startswith("spirob") or found.channels:
        return
    for number, (topic, (name, descriptor)) in enumerate(SCHEMAS.items(), 1):
        found.schemas[number] = Schema(id=number, data=descriptor, encoding="protobuf", name=name)
        found.channels[number] = Channel(
            id=number, topic=topic, message_encoding="protobuf", metadata={}, schema_id=number
        )
    found.note("the channels were declared in a lost chunk and taken from the writer's own list")


def _register(found: Survey, writer: Writer) -> Iterator[tuple[int, int]]:
    schemas = {0: 0}
    for channel in found.channels.values():
        schema = found.schemas.get(channel.schema_id)
        if schema is not None and schema.id not in schemas:
            schemas[schema.id] = writer.register_schema(schema.name, schema.encoding, schema.data)
        number = writer.register_channel(
            channel.topic,
            channel.message_encoding,
            schemas.get(channel.schema_id, 0),
            channel.metadata,
        )
        yield channel.id, number
