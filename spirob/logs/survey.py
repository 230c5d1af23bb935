"""What is whole in a damaged MCAP file, and what is not."""

import struct
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, DataEnd, Header, Metadata, Schema

from spirob.logs.locating import MESSAGE_HEAD, RECORD, records
from spirob.logs.payloads import stream, unpacking_limit
from spirob.logs.records import BROKEN, MAGIC, unpack_chunk
from spirob.logs.salvage import Gap, Place, whole_records

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
