"""The records of a damaged MCAP file that are whole, wherever the damage lies.

Records stand one after the other, so one wrong length hides all that follow.  A record is
therefore believed only where its own parts fill it exactly; otherwise the next place is searched
at which a chunk, an attachment, metadata, a schema or a channel does.
"""

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass

from mcap.opcode import Opcode

from spirob.logs.locating import MESSAGE_HEAD, RECORD

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
