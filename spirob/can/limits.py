"""Limits that no command may leave, and what stops a trial: a limit that is left, or a signal.

A command is brought within the limits in the drive's counts.  Reasons to stop are functions, each a
sentence about a motor, or None.  One bad frame is no reason: all but silence must hold for several
frames.  Ctrl-C and SIGTERM come between two cycles.
"""

import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import FrameType

from spirob.can.motor import TIMES, Flicker, MotorState
from spirob.can_protocol import (
    AMPERE_PER_COUNT,
    COUNTS_PER_TURN,
    VOLT_PER_COUNT,
    CanFrame,
    command_counts,
    command_payload,
)
from spirob.errors import HardwareError
from spirob.parameter import Numbers, bounded
from spirob.robot import CYCLE_NS, MOTORS


class Limits(Numbers):
    """Wide defaults, which the drive itself nearly keeps; a real robot's configuration has its own.

    Commands beyond `current` and `slew`, and voltages beyond theirs, are brought back to them;
    anything else stops the trial.
    `speed` times `silence` should stay below half a rotor turn, so that lost frames cannot hide
    a whole one.
    """

    owner = "safety"

    current: float = bounded(20.0, 0.01, 20.0, "A", "i_max", "size of a commanded current")
    slew: float = bounded(4e4, 1.0, 1e6, "A/s", "s_max", "rate of a commanded current")
    voltage: float = bounded(24.0, 0.1, 24.0, "V", "u_max", "size of a commanded voltage")
    voltage_slew: float = bounded(4.8e4, 1.0, 1e6, "V/s", "u̇_max", "rate of a commanded voltage")
    travel: float = bounded(1.0, 0.001, 10.0, "m", "x_max", "wound-in length since the start")
    speed: float = bounded(5.0, 0.001, 100.0, "m/s", "v_max", "speed of a tendon")
    temperature: float = bounded(100.0, 30.0, 150.0, "degC", "T_max", "winding, as reported")
    silence: float = bounded(0.010, 0.002, 1.0, "s", "t_s", "without feedback of a motor")
    following: float = bounded(1.0, 0.01, 40.0, "A", "e_max", "command less reported current")
    following_time: float = bounded(0.25, 0.005, 10.0, "s", "t_e", "for how long, at a stretch")
    frozen: float = bounded(0.05, 0.005, 10.0, "s", "t_f", "with bit-identical feedback")


FRAME_PLACES = 4  # a command frame has room for four drives


class CommandLimiter:
    """Keeps what was sent last; a command within the limits passes unchanged, to the bit.

    most, slew  [A], [A/s] of currents, or [V], [V/s] of voltages;  per_count  their unit in a count
    Drives that do not belong to the robot get zero.  Going to zero as a stop is not limited: that
    does not pass through here.
    """

    def __init__(self, most: float, slew: float, per_count: float) -> None:
        self._high = int(most / per_count + 1e-9)
        self._step = max(1, int(slew * CYCLE_NS * 1e-9 / per_count + 1e-9))
        self._per_count = per_count
        self.sent = (0,) * FRAME_PLACES

    def __call__(self, command: bytes) -> bytes:
        """The payload to send; raises DataError where the command is none."""
        asked = command_counts(command)
        high, step = self._high, self._step
        allowed = tuple(
            max(-high, before - step, min(high, before + step, count)) if m < len(MOTORS) else 0
            for m, (count, before) in enumerate(zip(asked, self.sent, strict=True))
        )
        self.sent = allowed
        return command if allowed == asked else command_payload(allowed)

    def value(self, motor: int) -> float:
        """What was last sent to a motor [A], or [V] of voltages."""
        return self.sent[motor] * self._per_count

    def stop(self) -> None:
        """Zero was sent."""
        self.sent = (0,) * FRAME_PLACES


def of_currents(limits: Limits) -> CommandLimiter:
    """The limits of commanded currents."""
    return CommandLimiter(limits.current, limits.slew, AMPERE_PER_COUNT)


def of_voltages(limits: Limits) -> CommandLimiter:
    """The limits of commanded voltages."""
    return CommandLimiter(limits.voltage, limits.voltage_slew, VOLT_PER_COUNT)


class Stopped(HardwareError):
    """The current is zero again, and says why; `frames` arrived in the cycle that it ended."""

    def __init__(self, reason: str, frames: Sequence[CanFrame] = ()):
        super().__init__(reason)
        self.frames = list(frames)


SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)


@contextmanager
def interruptible() -> Iterator[Callable[[], None]]:
    """A function to call once a cycle: it raises where a signal has come since.

    Ctrl-C is raised as KeyboardInterrupt, any other as SystemExit with code 128 + its number.  A
    second signal is raised where the program stands, for a loop that has got stuck.  Outside of
    the main thread signals stay as they are.
    """
    came: list[int] = []

    def handle(number: int, frame: FrameType | None) -> None:
        came.append(number)
        if len(came) > 1:
            raise _error(number)

    def check() -> None:
        if came:
            raise _error(came[0])

    if threading.current_thread() is not threading.main_thread():
        yield check
        return
    before = {number: signal.signal(number, handle) for number in SIGNALS}
    try:
        yield check
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _error(number: int) -> BaseException:
    return KeyboardInterrupt() if number == signal.SIGINT else SystemExit(128 + number)


PATIENCE = 3  # frames in a row
ASTRAY = COUNTS_PER_TURN // 8  # in trials of the emulated robot at most 22 counts
MOVED = 0.2  # A: a command that changed by this much must show in the feedback
PUSHED = 0.1  # V: the same of a voltage, 4 counts of current through the 20 Ω that a rig may have


@dataclass
class Span:
    """The latest of what goes out, and its range since the feedback last changed."""

    latest: float = 0.0
    lowest: float = 0.0
    highest: float = 0.0

    def take(self, value: float) -> None:
        """The next one."""
        self.latest = value
        self.lowest, self.highest = min(self.lowest, value), max(self.highest, value)

    def begin(self) -> None:
        """The feedback has changed."""
        self.lowest = self.highest = self.latest

    @property
    def width(self) -> float:
        """How far they moved."""
        return self.highest - self.lowest


@dataclass
class Watched:
    """One motor as the reasons see it.

    by_voltage   whether the drive is told a voltage, so that nothing but the host holds its current
    asked    currents [A];  driven  voltages [V], zero of drives that take none
    unlike   since when command and reported current have been apart [ns], or None
    unmoved  since when the feedback has not shown a voltage that moved [ns], or None
    flicker  noise of its current reading at rest
    counts   frames in a row for which a reason has held
    """

    state: MotorState
    since_ns: int
    by_voltage: bool = False
    asked: Span = field(default_factory=Span)
    driven: Span = field(default_factory=Span)
    unlike_ns: int | None = None
    unmoved_ns: int | None = None
    flicker: Flicker = field(default_factory=Flicker)
    counts: dict[str, int] = field(default_factory=dict)

    @property
    def sent(self) -> float:
        """Latest current that was asked for [A]."""
        return self.asked.latest

    def command(self, amperes: float, volts: float) -> None:
        """What goes out in this cycle."""
        self.asked.take(amperes)
        self.driven.take(volts)

    def changed(self) -> None:
        """The feedback has said something new."""
        self.asked.begin()
        self.driven.begin()


Reason = Callable[[Watched, Limits, int], str | None]


def silence(motor: Watched, limits: Limits, now_ns: int) -> str | None:
    """No feedback for too long; before its first answer a motor may take its time at zero."""
    if not motor.state.answered and motor.sent == 0.0:
        return None
    silent = now_ns - max(motor.since_ns, motor.state.heard_ns)
    return f"no feedback for {silent / 1e6:.0f} ms" if silent >= limits.silence * 1e9 else None


def travel(motor: Watched, limits: Limits, now_ns: int) -> str | None:
    """Wound in or paid out too far."""
    x = motor.state.displacement
    if abs(x) > limits.travel:
        return f"tendon at {1e3 * x:.1f} mm, limit {1e3 * limits.travel:g} mm"
    return None


def speed(motor: Watched, limits: Limits, now_ns: int) -> str | None:
    """Too fast."""
    v = motor.state.velocity
    return f"tendon at {v:.3f} m/s, limit {limits.speed:g} m/s" if abs(v) > limits.speed else None


def temperature(motor: Watched, limits: Limits, now_ns: int) -> str | None:
    """Winding too hot."""
    hot = motor.state.temperature
    if hot > limits.temperature:
        return f"winding at {hot:.0f} °C, limit {limits.temperature:g} °C"
    return None


def encoder(motor: Watched, limits: Limits, now_ns: int) -> str | None:
    """Angle and speed tell two stories: an encoder that jumps or sticks."""
    astray = motor.state.astray
    if abs(astray) > ASTRAY:
        return f"encoder and speed disagree by {astray / COUNTS_PER_TURN:+.2f} turns"
    return None


def following(motor: Watched, limits: Limits, now_ns: int) -> str | None:
    """The drive does not carry the current that it was told to."""
    error = motor.sent - motor.state.current
    if abs(error) <= limits.following:
        motor.unlike_ns = None
        return None
    if motor.unlike_ns is None:
        motor.unlike_ns = now_ns
    lasted = (now_ns - motor.unlike_ns) * 1e-9
    if lasted <= limits.following_time:
        return None
    return f"current is {error:+.2f} A from the command for {1e3 * lasted:.0f} ms"


def overcurrent(motor: Watched, limits: Limits, now_ns: int) -> str | None:
    """A motor under a voltage carries more than may be asked for, and more than it may be apart."""
    current, more = motor.state.current, limits.following
    if not motor.by_voltage or abs(current) <= limits.current + more:
        return None
    return f"current is {current:+.2f} A, limit {limits.current:g} A and {more:g} A more"


def frozen(motor: Watched, limits: Limits, now_ns: int) -> str | None:
    """Feedback comes, but always the same, although the command changes."""
    lasted = (now_ns - motor.state.changed_ns) * 1e-9
    moved = motor.asked.width
    if lasted <= limits.frozen or moved < MOVED:
        return None
    return f"the same feedback for {1e3 * lasted:.0f} ms while the command moved {moved:.2f} A"


def stale(motor: Watched, limits: Limits, now_ns: int) -> str | None:
    """Feedback comes, but does not show a voltage that moved: a current may run away unseen."""
    if motor.driven.width < PUSHED:
        motor.unmoved_ns = None
        return None
    if motor.unmoved_ns is None:
        motor.unmoved_ns = now_ns
    lasted = now_ns - motor.unmoved_ns
    if lasted < limits.silence * 1e9:
        return None
    moved = motor.driven.width
    return f"the same feedback for {lasted / 1e6:.0f} ms after the voltage moved {moved:.2f} V"


def lifeless(motor: Watched, limits: Limits, now_ns: int) -> str | None:
    """Always the same feedback under a constant command, from a drive whose reading flickers."""
    lasted = now_ns - motor.state.changed_ns
    least = max(limits.frozen * 1e9, TIMES * motor.flicker.longest_ns)
    if lasted <= least or not motor.flicker.expected(motor.sent):
        return None
    return f"the same feedback for {lasted / 1e6:.0f} ms from a drive whose reading flickers"


AT_ONCE: tuple[Reason, ...] = (silence, stale)
LASTING: tuple[Reason, ...] = (
    travel,
    speed,
    temperature,
    encoder,
    overcurrent,
    following,
    frozen,
    lifeless,
)


def reason_to_stop(motor: Watched, limits: Limits, now_ns: int, heard: bool) -> str | None:
    """The first reason that holds; `heard` where this cycle brought feedback of the motor."""
    for reason in AT_ONCE:
        found = reason(motor, limits, now_ns)
        if found:
            return found
    if not heard:
        return None
    for reason in LASTING:
        found = reason(motor, limits, now_ns)
        count = motor.counts.get(reason.__name__, 0) + 1 if found else 0
        motor.counts[reason.__name__] = count
        if found and count >= PATIENCE:
            return found
    return None
