"""CAN frames of C620-style drives: 11-bit ids, eight bytes, big-endian, 1 Mbit/s.

`c620.dbc` is the single truth.  cantools reads it; because all fields are aligned to bytes the
same layouts are compiled here to `struct` and `numpy` for speed, and a test proves both equal on
random payloads.  Counts become SI units in `can` and `logs`, nowhere else.

Voltages are a command payload, too, as GM6020-style motors take it: ±25000 counts = ±24 V.  Their
DBC file, `gm6020.dbc`, is the truth; a test proves both equal.

Besides: whether an interface of python-can can be used here, before it is opened.
"""

import struct
from dataclasses import dataclass
from importlib import resources
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np

from spirob.errors import DataError, HardwareError

if TYPE_CHECKING:
    from cantools.database import Database


COMMAND_ID = 0x200
FEEDBACK_ID = 0x200  # plus the drive's number, from 1
AMPERE_PER_COUNT = 20.0 / 16384.0  # C620: ±16384 counts = ±20 A
COUNTS_PER_TURN = 8192  # rotor angle
VOLTAGE_ID = 0x1FF
VOLTAGE_FEEDBACK_ID = 0x204  # plus the motor's number, from 1
FULL_SCALE = 25000  # counts
VOLT_PER_COUNT = 24.0 / FULL_SCALE
PLACES = 4  # motors in a frame
_COMMAND = struct.Struct(">4h")
_FEEDBACK = struct.Struct(">HhhBx")
_FEEDBACK_ARRAY = np.dtype(
    [("angle", ">u2"), ("speed", ">i2"), ("current", ">i2"), ("temperature", "u1"), ("", "u1")]
)


@dataclass(frozen=True, slots=True)
class CanFrame:
    """One frame as it was on the bus; stamp_ns is when it was received or sent."""

    stamp_ns: int
    arbitration_id: int
    data: bytes


@dataclass(frozen=True, slots=True)
class Feedback:
    """What a drive says once a cycle, in its own counts.

    angle        rotor angle, 0..8191 a turn
    speed        rotor speed [rpm]
    current      torque current [counts of 20/16384 A]
    temperature  of the winding [°C]
    """

    angle: int
    speed: int
    current: int
    temperature: int


def database() -> "Database":
    """The DBC file as cantools reads it."""
    import cantools  # slow to import, and only needed where the DBC itself is asked for

    text = resources.files("spirob").joinpath("c620.dbc").read_text(encoding="ascii")
    loaded = cantools.database.load_string(text, database_format="dbc")
    assert isinstance(loaded, cantools.database.Database)
    return loaded


def encode_command(currents: tuple[float, ...]) -> bytes:
    """The command frame's payload for up to four currents [A], rounded to counts."""
    counts = [max(-16384, min(16384, round(i / AMPERE_PER_COUNT))) for i in currents]
    return _COMMAND.pack(*counts, *([0] * (4 - len(counts))))


def decode_command(data: bytes, motors: int = 2) -> tuple[float, ...]:
    """The currents [A] in a command payload."""
    if len(data) != _COMMAND.size:
        raise DataError(f"a command frame has {len(data)} bytes; the DBC file says 8")
    return tuple(c * AMPERE_PER_COUNT for c in _COMMAND.unpack(data)[:motors])


def command_counts(data: bytes) -> tuple[int, ...]:
    """The four currents of a command payload in counts; raises DataError on another size."""
    if len(data) != _COMMAND.size:
        raise DataError(f"a command frame has {len(data)} bytes; the DBC file says 8")
    return _COMMAND.unpack(data)


def command_payload(counts: tuple[int, ...]) -> bytes:
    """The command frame's payload for four currents in counts."""
    return _COMMAND.pack(*counts)


def encode_volts(volts: tuple[float, ...]) -> bytes:
    """The payload for up to four voltages [V], rounded to counts; what is no number is zero."""
    counts = [round(max(-24.0, min(24.0, u)) / VOLT_PER_COUNT) if u == u else 0 for u in volts]
    return command_payload((*counts, *([0] * (PLACES - len(counts)))))


def decode_volts(data: bytes, motors: int = 2) -> tuple[float, ...]:
    """The voltages [V] in a payload; raises DataError on another size."""
    return tuple(count * VOLT_PER_COUNT for count in command_counts(data)[:motors])


def encode_feedback(feedback: Feedback) -> bytes:
    """The feedback frame's payload."""
    return _FEEDBACK.pack(feedback.angle, feedback.speed, feedback.current, feedback.temperature)


def decode_feedback(data: bytes) -> Feedback:
    """One feedback payload in counts."""
    if len(data) != _FEEDBACK.size:
        raise DataError(f"a feedback frame has {len(data)} bytes; the DBC file says 8")
    return Feedback(*_FEEDBACK.unpack(data))


def feedback_payloads(
    angle: np.ndarray, speed: np.ndarray, current: np.ndarray, temperature: np.ndarray
) -> np.ndarray:
    """Many feedback payloads, (n, 8) uint8, from counts."""
    out = np.zeros(len(angle), _FEEDBACK_ARRAY)
    out["angle"], out["speed"] = angle, speed
    out["current"], out["temperature"] = current, temperature
    return out.view(np.uint8).reshape(-1, 8)


def decode_feedback_array(data: np.ndarray) -> np.ndarray:
    """Many feedback payloads, (n, 8) uint8, as a structured array of counts."""
    return np.ascontiguousarray(data, dtype=np.uint8).view(_FEEDBACK_ARRAY)[:, 0]


# interface -> the module that it needs beside python-can, which extra `can` brings
NEEDS = {
    "udp_multicast": "msgpack",
    "robotell": "serial",
    "seeedstudio": "serial",
    "serial": "serial",
    "slcan": "serial",
}
PACKAGES = {"serial": "pyserial"}


def require_known(interface: str, what: str) -> None:
    """Raises HardwareError, about `what`, where python-can has no such interface."""
    import can  # slow to import, and only needed where a bus is to be opened

    if interface not in can.VALID_INTERFACES:
        known = ", ".join(sorted(can.VALID_INTERFACES))
        raise HardwareError(f"{what}: no interface '{interface}'; known: {known}")


def require_interface(interface: str, what: str) -> None:
    """Raises HardwareError, about `what`, where there is no such interface or its library lacks."""
    require_known(interface, what)
    module = NEEDS.get(interface)
    if module and find_spec(module) is None:
        package = PACKAGES.get(module, module)
        raise HardwareError(
            f"{what}: {interface} needs {package}, which is not installed: "
            f'pip install -e ".[can]", or pip install {package}'
        )
