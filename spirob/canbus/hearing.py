"""Frames from a bus that is only listened to."""

import time
from collections.abc import Iterator

import can

from spirob.can_protocol import COMMAND_ID, CanFrame
from spirob.drives import Drive, Translator
from spirob.errors import HardwareError

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
