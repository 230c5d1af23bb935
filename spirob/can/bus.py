"""A CAN bus through python-can: opened, listened to without saying anything, and checked.

`check` puts it through its paces at zero current, before the first motion.
"""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import can
import numpy as np

from spirob.can.drive import Drive, Translator
from spirob.can.robot import CanRobot
from spirob.can_protocol import COMMAND_ID, FEEDBACK_ID, CanFrame, encode_command, require_interface
from spirob.errors import HardwareError
from spirob.robot import CYCLE_NS, MOTORS

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


ZERO = encode_command((0.0,) * len(MOTORS))
LOST = 0.01  # of the feedback of a motor
LATE = 0.01  # of the cycles that were skipped
WARM_UP = 100  # cycles that do not count
DRIFT = 1e-3  # of the clock that times the cycles against the wall's


@dataclass
class Paces:
    """What came of it.

    cycles   played;  skipped  not played because the computer was late
    rate     feedback a second of each motor;  lost  fraction of it that never came
    longest  cycles in a row without feedback of each motor
    delay    from command to feedback [s], 50 %, 99 % and the most, of each motor
    lateness of the cycles' ends [s], 50 %, 99 % and the most
    drift    of the time base of the log against the wall clock, relative
    faults   sentences about what is not good enough to move
    """

    cycles: int
    skipped: int
    rate: dict[str, float] = field(default_factory=dict)
    lost: dict[str, float] = field(default_factory=dict)
    longest: dict[str, int] = field(default_factory=dict)
    delay: dict[str, tuple[float, ...]] = field(default_factory=dict)
    lateness: tuple[float, ...] = (0.0, 0.0, 0.0)
    drift: float = 0.0
    faults: list[str] = field(default_factory=list)


def check(robot: CanRobot, seconds: float, drive: Drive | None = None) -> Paces:
    """Command zero for some seconds and look at what comes back; the robot is never armed.

    Raises HardwareError where the bus fails or a drive is silent.
    """
    interpret = Translator(drive) if drive else lambda frames: frames
    for _ in range(WARM_UP):
        robot.exchange(ZERO)
    skipped, wall, begin = robot.overruns, time.time_ns(), time.monotonic_ns()
    cycles = max(1, round(seconds * 1e9 / CYCLE_NS))
    heard: list[list[CanFrame]] = []
    ends = np.empty(cycles, np.int64)
    for k in range(cycles):
        heard.append(list(interpret(robot.exchange(ZERO))))
        ends[k] = time.monotonic_ns()
    found = Paces(cycles, robot.overruns - skipped)
    took, by_wall = time.monotonic_ns() - begin, time.time_ns() - wall
    found.drift = by_wall / took - 1.0
    late = (ends - ends[0]) % CYCLE_NS
    late = np.where(late > CYCLE_NS // 2, late - CYCLE_NS, late)
    found.lateness = _spread((late - late.min()) * 1e-9)
    for m, motor in enumerate(MOTORS):
        _motor(found, heard, m, motor, took * 1e-9)
    _judge(found)
    return found


def _motor(found: Paces, heard: list[list[CanFrame]], m: int, motor: str, seconds: float) -> None:
    delays, missing, row = [], [], 0
    for frames in heard:
        mine = [f for f in frames if f.arbitration_id == FEEDBACK_ID + 1 + m]
        delays += [(f.stamp_ns - frames[0].stamp_ns) * 1e-9 for f in mine]
        row = 0 if mine else row + 1
        missing.append(row)
    if not delays:
        raise HardwareError(f"no feedback from motor {motor}")
    found.rate[motor] = len(delays) / seconds
    # answers that come as a cycle ends fall now into this one, now into the next: none is lost,
    # and one may still be on its way
    short = len(heard) - len(delays)
    found.lost[motor] = short / len(heard) if short > 1 else 0.0
    found.longest[motor] = max(missing)
    found.delay[motor] = _spread(np.array(delays))


def _spread(values: np.ndarray) -> tuple[float, ...]:
    return (*(float(v) for v in np.percentile(values, (50, 99))), float(values.max()))


def _judge(found: Paces) -> None:
    for motor in MOTORS:
        if found.lost[motor] > LOST:
            found.faults.append(
                f"motor {motor}: {100 * found.lost[motor]:.1f} % of the feedback never came, "
                f"at most {100 * LOST:g} % may be lost"
            )
    if found.skipped > LATE * found.cycles:
        found.faults.append(
            f"{found.skipped} of {found.cycles} cycles were skipped because the computer was late; "
            "give the program real-time priority (docs/hardware.md)"
        )
    if abs(found.drift) > DRIFT:
        found.faults.append(f"the clock is off the wall clock by {100 * found.drift:+.2f} %")
