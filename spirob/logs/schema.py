"""What stands in a log: topics, message types and their protobuf descriptors.

`foxglove.JointStates` and `foxglove.JointState` are well-known schemas that viewers open without
set-up; field numbers as in foxglove-sdk 0.30.  The two `spirob` types have a fixed size, so that a
whole file of them is one numpy array.
"""

from dataclasses import dataclass

from spirob.logs.wire import field
from spirob.robot import MOTORS

RAW_TOPIC, JOINTS_TOPIC, COMMAND_TOPIC = "/can/raw", "/joint_states", "/command"
ABOUT, CONFIG_FILE, TRIAL_FILE = "spirob", "config.yaml", "trial.yaml"
DRIVE_FILE, DBC_FILE = "drive.yaml", "drive.dbc"  # of drives that are not C620-style
LOOP = "loop"  # metadata: how the loop kept its deadlines
STOPPED = "stopped"  # metadata of a trial that did not end well

DOUBLE, STRING, MESSAGE, BYTES, FIXED32, SFIXED64 = 1, 9, 11, 12, 7, 16
INT64, INT32 = 3, 5
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


_TIMESTAMP = _message("Timestamp", [Field("seconds", 1, INT64), Field("nanos", 2, INT32)])
_JOINT = _message(
    "JointState",
    [
        Field("name", 1, STRING),
        *(
            Field(name, number, DOUBLE, optional=True)
            for number, name in enumerate(("position", "velocity", "acceleration", "effort"), 2)
        ),
    ],
)
_JOINTS = _message(
    "JointStates",
    [
        Field("timestamp", 1, MESSAGE, ".google.protobuf.Timestamp"),
        Field("joints", 2, MESSAGE, ".foxglove.JointState", repeated=True),
    ],
)
_FRAME = _message(
    "CanFrame",
    [
        Field("stamp_ns", 1, SFIXED64),
        Field("arbitration_id", 2, FIXED32),
        Field("data", 3, BYTES),
    ],
)
_COMMAND = _message(
    "Command",
    [
        Field("stamp_ns", 1, SFIXED64),
        *(
            Field(f"{motor}_{name}", 2 + 4 * m + k, FIXED32 if name == "mode" else DOUBLE)
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
