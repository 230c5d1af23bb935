"""What stands in a log: topics, message types, their protobuf descriptors and the wire format.

`foxglove.JointStates` and `foxglove.JointState` are well-known schemas that viewers open without
set-up; field numbers as in foxglove-sdk 0.30.  The two `spirob` types have a fixed size, so that a
whole file of them is one numpy array: packed one at a time, unpacked a file at a time.

The wire format is as much of protobuf's as fixed little messages need.  Hand-packed, because a log
takes five messages a millisecond; see developers.google.com/protocol-buffers/docs/encoding.
"""

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

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


_TIMESTAMP_TYPE = _message(
    "Timestamp", [Field("seconds", 1, TYPE_INT64), Field("nanos", 2, TYPE_INT32)]
)
_JOINT_TYPE = _message(
    "JointState",
    [
        Field("name", 1, TYPE_STRING),
        *(
            Field(name, number, TYPE_DOUBLE, optional=True)
            for number, name in enumerate(("position", "velocity", "acceleration", "effort"), 2)
        ),
    ],
)
_JOINTS_TYPE = _message(
    "JointStates",
    [
        Field("timestamp", 1, TYPE_MESSAGE, ".google.protobuf.Timestamp"),
        Field("joints", 2, TYPE_MESSAGE, ".foxglove.JointState", repeated=True),
    ],
)
_FRAME_TYPE = _message(
    "CanFrame",
    [
        Field("stamp_ns", 1, TYPE_SFIXED64),
        Field("arbitration_id", 2, TYPE_FIXED32),
        Field("data", 3, TYPE_BYTES),
    ],
)
_COMMAND_TYPE = _message(
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
    RAW_TOPIC: ("spirob.CanFrame", _file("spirob/CanFrame.proto", "spirob", _FRAME_TYPE)),
    JOINTS_TOPIC: (
        "foxglove.JointStates",
        _file("google/protobuf/timestamp.proto", "google.protobuf", _TIMESTAMP_TYPE)
        + _file("foxglove/JointState.proto", "foxglove", _JOINT_TYPE)
        + _file(
            "foxglove/JointStates.proto",
            "foxglove",
            _JOINTS_TYPE,
            ("foxglove/JointState.proto", "google/protobuf/timestamp.proto"),
        ),
    ),
    COMMAND_TOPIC: ("spirob.Command", _file("spirob/Command.proto", "spirob", _COMMAND_TYPE)),
}


_STAMP, _ID = tag(1, FIXED64)[0], tag(2, FIXED32)[0]
_DATA = tag(3, BYTES) + b"\x08"  # a classic CAN payload of eight bytes
_FRAME = struct.Struct("<BqBI2s8s")
FRAME = np.dtype(
    [("_1", "u1"), ("stamp_ns", "<i8"), ("_2", "u1"), ("id", "<u4"), ("_3", "S2"), ("data", "8u1")]
)
_FRAME_TAGS = {"_1": _STAMP, "_2": _ID, "_3": _DATA}

_COMMAND = struct.Struct("<Bq" + "BdBdBdBI" * len(MOTORS))
_COMMAND_KIND = {name: FIXED32 if name == "mode" else FIXED64 for name in COMMAND_FIELDS}
_COMMAND_TAG = [
    tag(2 + 4 * m + k, _COMMAND_KIND[name])[0]
    for m in range(len(MOTORS))
    for k, name in enumerate(COMMAND_FIELDS)
]
_COLUMNS = [f"{motor}.{name}" for motor in MOTORS for name in COMMAND_FIELDS]
COMMAND = np.dtype(
    [("_0", "u1"), ("stamp_ns", "<i8")]
    + [
        part
        for k, column in enumerate(_COLUMNS)
        for part in ((f"_{k + 1}", "u1"), (column, "<u4" if column.endswith("mode") else "<f8"))
    ]
)
_COMMAND_TAGS = {"_0": _STAMP} | {f"_{k + 1}": t for k, t in enumerate(_COMMAND_TAG)}


def pack_frame(stamp_ns: int, arbitration_id: int, data: bytes) -> bytes:
    """`spirob.CanFrame`; a payload that has not eight bytes is kept as it is, at its own size."""
    if len(data) == 8:
        return _FRAME.pack(_STAMP, stamp_ns, _ID, arbitration_id, _DATA, data)
    return struct.pack("<BqBI", _STAMP, stamp_ns, _ID, arbitration_id) + field(3, data)


def pack_command(
    stamp_ns: int,
    currents: Sequence[float],
    references: Sequence[float],
    rates: Sequence[float],
    modes: Sequence[int],
) -> bytes:
    """`spirob.Command`: what was asked of both motors in one cycle."""
    a, b, c, d, e, f, g, h = _COMMAND_TAG
    return _COMMAND.pack(
        *(_STAMP, stamp_ns),
        *(a, currents[0], b, references[0], c, rates[0], d, modes[0]),
        *(e, currents[1], f, references[1], g, rates[1], h, modes[1]),
    )


class JointPacker:
    """`foxglove.JointStates` of tendons as prismatic joints: m, m/s, N."""

    def __init__(self, names: Sequence[str]):
        heads = [field(1, name) + tag(2, FIXED64) for name in names]
        layout = [f"{len(h) + 2}sdBdBd" for h in heads]
        self._heads = [
            tag(2, BYTES) + bytes([len(h) + struct.calcsize("<dBdBd")]) + h for h in heads
        ]
        self._pack = struct.Struct("<" + "".join(layout)).pack

    def __call__(
        self,
        stamp_ns: int,
        positions: Sequence[float],
        velocities: Sequence[float],
        efforts: Sequence[float],
    ) -> bytes:
        seconds, nanos = divmod(stamp_ns, 1_000_000_000)
        values: list[bytes | float] = []
        for head, x, v, f in zip(self._heads, positions, velocities, efforts, strict=True):
            values += (head, x, _VELOCITY, v, _EFFORT, f)
        return field(1, field(1, seconds) + field(2, nanos)) + self._pack(*values)


_VELOCITY, _EFFORT = tag(3, FIXED64)[0], tag(5, FIXED64)[0]


def unpack_frames(messages: np.ndarray | list[bytes]) -> tuple[np.ndarray, int]:
    """`FRAME` records of many messages, and how many were dropped as not eight bytes long.

    messages  (n, size) uint8 where all have one size, else a list.  Raises DataError on garbage.
    """
    records = _at_once(messages, FRAME, _FRAME_TAGS)
    if records is not None:
        return records, 0
    one_by_one = [bytes(message) for message in messages]
    usual = [message for message in one_by_one if len(message) == FRAME.itemsize]
    records = np.frombuffer(b"".join(usual), FRAME)
    if all(np.all(records[name] == t) for name, t in _FRAME_TAGS.items()):
        strangers = [message for message in one_by_one if len(message) != FRAME.itemsize]
        if not any(_frame_row(message) for message in strangers):
            return records, len(strangers)
    rows = [row for row in map(_frame_row, one_by_one) if row]
    return np.array(rows, FRAME), len(messages) - len(rows)


def _frame_row(message: bytes) -> tuple[object, ...] | None:
    found = fields(message)
    data = found.get(3, b"")
    if not isinstance(data, bytes) or len(data) != 8:
        return None
    stamp, number = integer(found.get(1)), integer(found.get(2)) & 0xFFFFFFFF
    return _STAMP, stamp, _ID, number, _DATA, np.frombuffer(data, np.uint8)


def unpack_commands(messages: np.ndarray | list[bytes]) -> np.ndarray:
    """`COMMAND` records of many messages; arguments and errors as for frames."""
    records = _at_once(messages, COMMAND, _COMMAND_TAGS)
    if records is not None:
        return records
    out = np.zeros(len(messages), COMMAND)
    for record, message in zip(out, messages, strict=True):
        found = fields(bytes(message))
        record["stamp_ns"] = integer(found.get(1))
        for number, column in enumerate(_COLUMNS, 2):
            value = found.get(number)
            is_mode = column.endswith("mode")
            record[column] = integer(value) & 0xFFFFFFFF if is_mode else double(value)
    return out


def _at_once(
    messages: np.ndarray | list[bytes], layout: np.dtype, tags: Mapping[str, object]
) -> np.ndarray | None:
    if not isinstance(messages, np.ndarray) or messages.shape[1] != layout.itemsize:
        return None
    records = np.ascontiguousarray(messages).view(layout)[:, 0]
    return records if all(np.all(records[name] == t) for name, t in tags.items()) else None
