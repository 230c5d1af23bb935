"""A CAN bus through python-can: opened, and listened to without saying anything."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import can
import numpy as np

from spirob.can_interface import require_interface
from spirob.can_protocol import COMMAND_ID, FEEDBACK_ID, CanFrame
from spirob.drives import Drive, Translator
from spirob.errors import HardwareError
from spirob.robot import MOTORS

BITRATE = 1_000_000  # of C620-style drives; a wrong rate sends the bus into error, not the drive


def open_bus(interface: str, channel: str, bitrate: int = BITRATE, **options: Any) -> can.BusABC:
    """An open bus; `interface`, `channel` and further options are python-can's own.

    interface  e.g. "pcan", "socketcan", "virtual";  channel e.g. "PCAN_USBBUS1", "can0"
    bitrate    [bit/s]; socketcan takes it from the system, where it is set with `ip link`

    Raises HardwareError naming the interface, the channel, and what to install.
    """
    what = f"CAN bus {interface}:{channel}"
    require_interface(interface, what)
    try:
        bus = can.Bus(interface=interface, channel=channel, bitrate=bitrate, **options)
    except (can.CanError, OSError, ImportError, ValueError, TypeError, NameError) as error:
        raise HardwareError(f"{what} cannot be opened: {error}") from error
    if bus.channel_info == can.BusABC.channel_info:  # not every interface names itself
        bus.channel_info = f"{interface}:{channel}"
    return bus


PATIENCE = 0.1  # s
NO_COMMAND = bytes(8)


def heard(bus: can.BusABC, seconds: float, drive: Drive | None = None) -> Iterator[CanFrame | None]:
    """Frames as C620-style ones, in the order of arrival; None when none came for `PATIENCE`.

    seconds  of the wall clock after which it ends
    drive    what the drives are where they are not C620-style
    Nothing is ever sent.  Raises HardwareError where the bus fails.
    """
    translate = Translator(drive) if drive else None
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        try:
            message = bus.recv(min(left, PATIENCE))
        except (can.CanError, OSError) as error:
            raise HardwareError(f"{bus.channel_info}: receiving failed: {error}") from error
        if message is None:
            yield None
            continue
        if message.is_error_frame or message.is_remote_frame or message.is_extended_id:
            continue
        # the stamp of the interface, which knows better than we when the frame came
        stamp = round(1e9 * message.timestamp)
        frame = CanFrame(stamp, message.arbitration_id, bytes(message.data))
        if translate is None:
            yield frame
        else:
            yield from translate([CanFrame(stamp, COMMAND_ID, NO_COMMAND), frame])[1:]


MOST = 2_000_000  # frames; a flooded bus must not fill the memory


@dataclass(frozen=True)
class Heard:
    """One arbitration id: frames, mean rate [1/s], longest pause [s], payload sizes, what it is."""

    number: int
    extended: bool
    frames: int
    rate: float
    pause: float
    sizes: tuple[int, ...]
    meaning: str


def listen(bus: can.BusABC, seconds: float, drives: Sequence[Drive] = ()) -> list[Heard]:
    """All ids heard in some seconds, by number; raises HardwareError where the bus fails."""
    arrived: dict[tuple[int, bool], list[float]] = {}
    sizes: dict[tuple[int, bool], set[int]] = {}
    end = time.monotonic() + seconds
    for _ in range(MOST):
        left = end - time.monotonic()
        if left <= 0:
            break
        try:
            message = bus.recv(left)
        except (can.CanError, OSError) as error:
            raise HardwareError(f"{bus.channel_info}: receiving failed: {error}") from error
        if message is None or message.is_error_frame:
            continue
        key = (message.arbitration_id, message.is_extended_id)
        arrived.setdefault(key, []).append(time.monotonic())
        sizes.setdefault(key, set()).add(len(message.data))
    return [
        _heard(key, np.array(arrived[key]), sizes[key], seconds, meanings(drives))
        for key in sorted(arrived)
    ]


def _heard(
    key: tuple[int, bool], at: np.ndarray, sizes: set[int], seconds: float, known: dict[int, str]
) -> Heard:
    number, extended = key
    pause = float(np.diff(at).max()) if len(at) > 1 else seconds
    meaning = "" if extended else known.get(number, "")
    return Heard(number, extended, len(at), len(at) / seconds, pause, tuple(sorted(sizes)), meaning)


def meanings(drives: Sequence[Drive]) -> dict[int, str]:
    """What an id would be on a bus of C620-style drives, and of others."""
    found = {COMMAND_ID: "c620 command"}
    found |= {FEEDBACK_ID + 1 + m: f"c620 feedback, {motor}" for m, motor in enumerate(MOTORS)}
    for drive in drives:
        for message in drive.codec.messages():
            number, told = message.frame_id, f"{drive.about.name} {message.name}"
            found[number] = f"{found[number]}, or {told}" if number in found else told
    return found
