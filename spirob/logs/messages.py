"""The three messages of a log, packed one at a time and unpacked a file at a time."""

import struct
from collections.abc import Mapping, Sequence

import numpy as np

from spirob.logs.schema import (
    BYTES,
    COMMAND_FIELDS,
    FIXED32,
    FIXED64,
    double,
    field,
    fields,
    integer,
    tag,
)
from spirob.robot import MOTORS

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
