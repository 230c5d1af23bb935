"""A trial stopped for safety, and Ctrl-C and SIGTERM between two cycles.

Reasons to stop are functions, each a sentence about a motor, or None.  One bad frame is no reason:
all but silence must hold for several frames.
"""

import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import FrameType

from spirob.can_protocol import COUNTS_PER_TURN, CanFrame
from spirob.errors import HardwareError
from spirob.safety.limits import Limits
from spirob.safety.motor import TIMES, Flicker, MotorState


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


@dataclass
class Watched:
    """One motor as the reasons see it.

    by_voltage   whether the drive is told a voltage, so that nothing but the host holds its current
    sent     latest command [A];  lowest, highest  of the commands since the feedback last changed
    unlike   since when command and reported current have been apart [ns], or None
    flicker  noise of its current reading at rest
    counts   frames in a row for which a reason has held
    """

    state: MotorState
    since_ns: int
    by_voltage: bool = False
    sent: float = 0.0
    lowest: float = 0.0
    highest: float = 0.0
    unlike_ns: int | None = None
    flicker: Flicker = field(default_factory=Flicker)
    counts: dict[str, int] = field(default_factory=dict)

    def command(self, amperes: float) -> None:
        """What goes out in this cycle."""
        self.sent = amperes
        self.lowest, self.highest = min(self.lowest, amperes), max(self.highest, amperes)

    def changed(self) -> None:
        """The feedback has said something new."""
        self.lowest = self.highest = self.sent


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
    return (
        f"tendon at {1e3 * x:.1f} mm, limit {1e3 * limits.travel:g} mm"
        if (abs(x) > limits.travel)
        else None
    )


def speed(motor: Watched, limits: Limits, now_ns: int) -> str | None:
    """Too fast."""
    v = motor.state.velocity
    return f"tendon at {v:.3f} m/s, limit {limits.speed:g} m/s" if abs(v) > limits.speed else None


def temperature(motor: Watched, limits: Limits, now_ns: int) -> str | None:
    """Winding too hot."""
    hot = motor.state.temperature
    return (
        f"winding at {hot:.0f} °C, limit {limits.temperature:g} °C"
        if (hot > limits.temperature)
        else None
    )


def encoder(motor: Watched, limits: Limits, now_ns: int) -> str | None:
    """Angle and speed tell two stories: an encoder that jumps or sticks."""
    astray = motor.state.astray
    return (
        f"encoder and speed disagree by {astray / COUNTS_PER_TURN:+.2f} turns"
        if (abs(astray) > ASTRAY)
        else None
    )


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
    moved = motor.highest - motor.lowest
    if lasted <= limits.frozen or moved < MOVED:
        return None
    return f"the same feedback for {1e3 * lasted:.0f} ms while the command moved {moved:.2f} A"


def lifeless(motor: Watched, limits: Limits, now_ns: int) -> str | None:
    """Always the same feedback under a constant command, from a drive whose reading flickers."""
    lasted = now_ns - motor.state.changed_ns
    least = max(limits.frozen * 1e9, TIMES * motor.flicker.longest_ns)
    if lasted <= least or not motor.flicker.expected(motor.sent):
        return None
    return f"the same feedback for {lasted / 1e6:.0f} ms from a drive whose reading flickers"


AT_ONCE: tuple[Reason, ...] = (silence,)
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
