"""A bus put through its paces at zero current, before the first motion."""

import time
from dataclasses import dataclass, field

import numpy as np

from spirob.can_protocol import FEEDBACK_ID, CanFrame, encode_command
from spirob.canbus.robot import CanRobot
from spirob.drives import Drive, Translator
from spirob.errors import HardwareError
from spirob.robot import CYCLE_NS, MOTORS

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
