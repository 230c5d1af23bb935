"""What can be heard on a bus without saying anything."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import can
import numpy as np

from spirob.can_protocol import COMMAND_ID, FEEDBACK_ID
from spirob.drives import Drive
from spirob.errors import HardwareError
from spirob.robot import MOTORS

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
