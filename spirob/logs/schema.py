"""What stands in a log: topics, message types, their protobuf descriptors and the wire format.

`foxglove.JointStates` and `foxglove.JointState` are well-known schemas that viewers open without
set-up; field numbers as in foxglove-sdk 0.30.  The two `spirob` types have a fixed size, so that a
whole file of them is one numpy array.

The wire format is as much of protobuf's as fixed little messages need.  Hand-packed, because a log
takes five messages a millisecond; see developers.google.com/protocol-buffers/docs/encoding.
"""

import struct
from dataclasses import dataclass

from spirob.errors import DataError
from spirob.robot import MOTORS

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


RAW_TOPIC, JOINTS_TOPIC, COMMAND_TOPIC = "/can/raw", "/joint_states", "/command"
ABOUT, CONFIG_FILE, TRIAL_FILE = "spirob", "config.yaml", "trial.yaml"
DRIVE_FILE, DBC_FILE = "drive.yaml", "drive.dbc"  # of drives that are not C620-style
LOOP = "loop"  # metadata: how the loop kept its deadlines
STOPPED = "stopped"  # metadata of a trial that did not end well

TYPE_DOUBLE, TYPE_STRING, TYPE_MESSAGE, TYPE_BYTES, TYPE_FIXED32, TYPE_SFIXED64 = (
    1,
    9,
    11,
    12,
    7,
    16,
)
TYPE_INT64, TYPE_INT32 = 3, 5
COMMAND_FIELDS = ("current", "reference", "reference_rate", "mode")


@dataclass(frozen=True)
class Field:
    """One field of a message type, in protobuf's own terms."""

    name: str
    number: int
    kind: int
    type_name: str = ""
    repeated: bool = False
    optional: bool = False


def _message(name: str, members: list[Field]) -> bytes:
    # DescriptorProto: name 1, field 2, oneof_decl 8
    optional = [m for m in members if m.optional]
    out = field(1, name)
    for m in members:
        about = field(1, m.name) + field(3, m.number) + field(4, 3 if m.repeated else 1)
        about += field(5, m.kind)
        if m.type_name:
            about += field(6, m.type_name)
        if m.optional:  # proto3 keeps presence by a oneof with a single member
            about += field(9, optional.index(m)) + field(17, 1)
        out += field(2, about)
    for m in optional:
        out += field(8, field(1, f"_{m.name}"))
    return out


def _file(name: str, package: str, message: bytes, imports: tuple[str, ...] = ()) -> bytes:
    # FileDescriptorSet: file 1; FileDescriptorProto: name 1, package 2, dependency 3,
    # message_type 4, syntax 12
    needed = b"".join(field(3, i) for i in imports)
    return field(
        1, field(1, name) + field(2, package) + needed + field(4, message) + field(12, "proto3")
    )


_TIMESTAMP = _message("Timestamp", [Field("seconds", 1, TYPE_INT64), Field("nanos", 2, TYPE_INT32)])
_JOINT = _message(
    "JointState",
    [
        Field("name", 1, TYPE_STRING),
        *(
            Field(name, number, TYPE_DOUBLE, optional=True)
            for number, name in enumerate(("position", "velocity", "acceleration", "effort"), 2)
        ),
    ],
)
_JOINTS = _message(
    "JointStates",
    [
        Field("timestamp", 1, TYPE_MESSAGE, ".google.protobuf.Timestamp"),
        Field("joints", 2, TYPE_MESSAGE, ".foxglove.JointState", repeated=True),
    ],
)
_FRAME = _message(
    "CanFrame",
    [
        Field("stamp_ns", 1, TYPE_SFIXED64),
        Field("arbitration_id", 2, TYPE_FIXED32),
        Field("data", 3, TYPE_BYTES),
    ],
)
_COMMAND = _message(
    "Command",
    [
        Field("stamp_ns", 1, TYPE_SFIXED64),
        *(
            Field(f"{motor}_{name}", 2 + 4 * m + k, TYPE_FIXED32 if name == "mode" else TYPE_DOUBLE)
            for m, motor in enumerate(MOTORS)
            for k, name in enumerate(COMMAND_FIELDS)
        ),
    ],
)

# topic -> (type name, FileDescriptorSet)
SCHEMAS = {
    RAW_TOPIC: ("spirob.CanFrame", _file("spirob/CanFrame.proto", "spirob", _FRAME)),
    JOINTS_TOPIC: (
        "foxglove.JointStates",
        _file("google/protobuf/timestamp.proto", "google.protobuf", _TIMESTAMP)
        + _file("foxglove/JointState.proto", "foxglove", _JOINT)
        + _file(
            "foxglove/JointStates.proto",
            "foxglove",
            _JOINTS,
            ("foxglove/JointState.proto", "google/protobuf/timestamp.proto"),
        ),
    ),
    COMMAND_TOPIC: ("spirob.Command", _file("spirob/Command.proto", "spirob", _COMMAND)),
}
