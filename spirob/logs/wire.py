"""The protobuf wire format, as much of it as fixed little messages need.

Hand-packed, because a log takes five messages a millisecond; see developers.google.com/
protocol-buffers/docs/encoding for the format.
"""

import struct

from spirob.errors import DataError

VARINT, FIXED64, BYTES, FIXED32 = 0, 1, 2, 5


def varint(value: int) -> bytes:
    """A non-negative integer in base 128, low group first."""
    groups = bytearray()
    while value > 127:
        groups.append(value & 127 | 128)
        value >>= 7
    groups.append(value)
    return bytes(groups)


def tag(number: int, kind: int) -> bytes:
    """What stands before a field: its number and how it is written."""
    return varint(number << 3 | kind)


def field(number: int, value: int | str | bytes) -> bytes:
    """One field: an int as varint, text and bytes with their length."""
    if isinstance(value, int):
        return tag(number, VARINT) + varint(value)
    content = value.encode() if isinstance(value, str) else value
    return tag(number, BYTES) + varint(len(content)) + content


def fields(message: bytes) -> dict[int, int | bytes]:
    """The fields of a message by number; the last of a repeated one counts, as protobuf says.

    Fixed-size values come as their bytes.  Raises DataError where the message breaks off.
    """
    found: dict[int, int | bytes] = {}
    at = 0
    while at < len(message):
        key, at = _read_varint(message, at)
        kind = key & 7
        if kind == VARINT:
            value: int | bytes
            value, at = _read_varint(message, at)
        else:
            if kind == BYTES:
                size, at = _read_varint(message, at)
            elif kind in (FIXED64, FIXED32):
                size = 8 if kind == FIXED64 else 4
            else:
                raise DataError(f"a message uses the unknown wire type {kind}")
            value, at = message[at : at + size], at + size
        found[key >> 3] = value
    if at != len(message):
        raise DataError("a message breaks off inside a field")
    return found


def double(value: int | bytes | None) -> float:
    """A field read as double; absent means 0, as in proto3."""
    return struct.unpack("<d", value)[0] if isinstance(value, bytes) and len(value) == 8 else 0.0


def integer(value: int | bytes | None) -> int:
    """A fixed-size field as signed integer; absent or of another type means 0, as in proto3."""
    if isinstance(value, bytes) and len(value) in (4, 8):
        return int.from_bytes(value, "little", signed=True)
    return 0


def _read_varint(message: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while shift < 64:
        if at >= len(message):
            raise DataError("a message breaks off inside a number")
        value |= (message[at] & 127) << shift
        at, shift = at + 1, shift + 7
        if not message[at - 1] & 128:
            return value, at
    raise DataError("a message holds a number of more than 64 bits")
