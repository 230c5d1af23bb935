"""A robot with real drives, and its claim on the computer that runs its loop.

One exchange a millisecond, zero current when anything is wrong; how late cycles ended is kept.
"""

import gc
import os
import sys
import time
from array import array
from collections.abc import Callable
from contextlib import suppress

import can
import numpy as np

from spirob.can.drive import Drive
from spirob.can.limits import Stopped
from spirob.can_protocol import COMMAND_ID, FEEDBACK_ID, CanFrame, encode_command
from spirob.errors import HardwareError
from spirob.robot import CYCLE_NS, MOTORS, Scene

EDGES = (0, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000)  # µs, the last bin is open


class Lateness:
    """One number for each cycle [ns]; 8 bytes each."""

    def __init__(self) -> None:
        self._late = array("q")

    def ended(self, late_ns: int) -> None:
        """A cycle has come to its end that long after its deadline."""
        self._late.append(late_ns)

    def restart(self) -> None:
        """Forget everything, for another trial."""
        del self._late[:]

    def summary(self) -> dict[str, str]:
        """Number of cycles, median, 99 % and most [µs], and how many in each bin from `EDGES`."""
        late = np.maximum(np.frombuffer(self._late, np.int64), 0) / 1e3
        if not len(late):
            return {}
        counts, _ = np.histogram(late, [*EDGES, np.inf])
        middle, most_of = np.percentile(late, (50, 99))
        return {
            "cycles": str(len(late)),
            "lateness_p50_us": f"{middle:.1f}",
            "lateness_p99_us": f"{most_of:.1f}",
            "lateness_max_us": f"{late.max():.1f}",
            "histogram_from_us": " ".join(map(str, EDGES)),
            "histogram": " ".join(map(str, counts)),
        }


SWITCH = 1e-4  # s: how long another thread, the log's, may hold the interpreter at a stretch
PRIORITY = 50  # of SCHED_FIFO: above everything that is not real-time, below the kernel's own


class Urgency:
    """Taken when the loop begins, given back when it ends; both safe to call twice.

    lacking  a sentence where the system does not allow it, else empty
    """

    def __init__(self) -> None:
        self.lacking = ""
        self._taken = False
        self._before: tuple[int, os.sched_param] | None = None
        self._collecting = gc.isenabled()
        self._switch = sys.getswitchinterval()

    def take(self) -> None:
        """Claim what the system allows."""
        if self._taken:
            return
        self._taken, self._collecting = True, gc.isenabled()
        self._switch = sys.getswitchinterval()
        sys.setswitchinterval(SWITCH)
        gc.collect()
        gc.freeze()
        gc.disable()
        if not hasattr(os, "sched_setscheduler"):
            self.lacking = "this system has no real-time priority to give"
            return
        before = (os.sched_getscheduler(0), os.sched_getparam(0))
        try:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
        except OSError as error:
            self.lacking = f"no real-time priority: {error.strerror}; see docs/hardware.md"
        else:
            self._before = before

    @property
    def said(self) -> str:
        """What the loop runs with, in a phrase."""
        return self.lacking or f"SCHED_FIFO {PRIORITY}, no garbage collection in the loop"

    def give_back(self) -> None:
        """Leave everything as it was."""
        if not self._taken:
            return
        self._taken = False
        sys.setswitchinterval(self._switch)
        if self._before:
            os.sched_setscheduler(0, *self._before)
            self._before = None
        gc.unfreeze()
        if self._collecting:
            gc.enable()


def set_up(scene: Scene) -> str:
    """How arm and surroundings have to stand before a trial."""
    around = scene.cylinder
    put = "nothing near the arm"
    if around:
        put = (
            f"a cylinder of {1e3 * around.diameter:.1f} mm at x = {1e3 * around.x:.1f} mm, "
            f"y = {1e3 * around.y:.1f} mm"
        )
    if hung := scene.weights:
        put += f", weights of {hung.left:g} kg (left) and {hung.right:g} kg (right) on the drums"
    return f"Arm straight and at rest, tendons just taut, {put}; then press Enter. "


ZERO = encode_command((0.0,) * len(MOTORS))
SILENCE_NS = 10_000_000  # ten feedback frames lost in a row: the drive is gone
BACKLOG = 1000  # frames taken from the bus at once; a flooded bus must not hold up the command


class CanRobot:
    """The Robot protocol over a python-can bus, in real time.

    The end of each cycle is an absolute deadline, so lateness does not add up; cycles that were
    missed altogether are skipped and counted in `overruns`, never made up for in a burst.
    Frames carry the host's clock [ns since 1970], which does not jump during a trial.

    bus         open, owned from now on: `close` shuts it down
    silence_ns  how long a drive may say nothing
    drive       what the drives are where they are not C620-style; frames are then its own
    ask         told what to do before a trial and asked to arm; returns the operator's answer

    urgent      from the first cycle to the next `prepare` or `close` the loop runs at real-time
                priority and without garbage collection, where that is allowed

    Until `arm` no current is sent: a command that is not zero is an error.  Limits beyond that are
    the guard's (`can.guard`), which every trial is played through.
    """

    def __init__(
        self,
        bus: can.BusABC,
        silence_ns: int = SILENCE_NS,
        ask: Callable[[str], str] = input,
        drive: Drive | None = None,
        urgent: bool = False,
    ):
        self.overruns = 0
        self.armed = False
        self._bus = bus
        self._silence_ns = silence_ns
        self._ask = ask
        self._drive = drive
        self.urgency = Urgency() if urgent else None
        self._answers = [
            drive.frame_id(drive.motors[m].angle.message) if drive else FEEDBACK_ID + 1 + m
            for m in range(len(MOTORS))
        ]
        self._epoch_ns = time.time_ns() - time.monotonic_ns()
        self._deadline: int | None = None
        self._heard: dict[int, int] = {}
        self._frames: list[CanFrame] = []
        self._open = True
        self._lateness = Lateness()

    def prepare(self, scene: Scene, trial: str = "trial") -> None:
        """Disarm, hold zero current and ask the operator to set the scene."""
        self.armed = False
        if self.urgency:
            self.urgency.give_back()
        self._send(ZERO)
        self._ask(set_up(scene))
        self._deadline = None

    def arm(self) -> None:
        """Let currents flow once the operator has typed it; HardwareError on any other answer."""
        answer = self._ask("The motors will move. Keep clear, then type 'arm': ")
        if answer.strip().lower() != "arm":
            raise HardwareError("the robot was not armed, so no current was sent")
        if self._drive:
            self._send_all(self._drive.sent(self._drive.about.arm))
        self.armed = True
        self._deadline = None
        self._lateness.restart()
        self.overruns = 0

    def timing(self) -> dict[str, str]:
        """How the loop kept its deadlines since it was armed, as text for the log."""
        said = self.urgency.said if self.urgency else "not asked for"
        return {**self._lateness.summary(), "skipped": str(self.overruns), "priority": said}

    def exchange(self, command: bytes) -> list[CanFrame]:
        """One cycle: send, then collect frames up to its deadline.

        Raises HardwareError, after commanding zero, when the bus fails or a drive is silent
        (Stopped, which holds what had arrived in the cycle), or when a current is asked for while
        the robot is not armed.
        """
        self._frames = []
        if not self.armed and any(command):
            self._fail("a current was asked for, but the robot is not armed", None)
        if self._deadline is None:
            self._start()
        deadline = self._next_deadline(time.monotonic_ns())
        frames = self._frames
        frames += self._send(command)
        while (left := deadline - time.monotonic_ns()) > 0:
            self._receive(frames, left / 1e9)
        end = time.monotonic_ns()
        self._lateness.ended(end - deadline)
        self._drain(frames)  # what had arrived by the deadline still counts
        self._watch(end)  # later than that the bus was not read: nobody was silent
        return frames

    def close(self) -> None:
        """Command zero current and shut the bus down; safe to call twice."""
        self.armed = False
        if self.urgency:
            self.urgency.give_back()
        if self._open:
            self._open = False
            self._send_zero()
            if self._drive:
                with suppress(HardwareError):
                    self._send_all(self._drive.sent(self._drive.about.disarm))
            self._bus.shutdown()

    def _start(self) -> None:
        if self.urgency:
            self.urgency.take()
        # What came in while the operator was busy is old; a drive is not silent before the start.
        self._drain([])
        self._deadline = time.monotonic_ns()
        self._heard = dict.fromkeys(self._answers, self._deadline)

    def _next_deadline(self, now: int) -> int:
        assert self._deadline is not None
        deadline = self._deadline + CYCLE_NS
        if deadline <= now:
            missed = (now - deadline) // CYCLE_NS + 1
            self.overruns += missed
            deadline += missed * CYCLE_NS
        self._deadline = deadline
        return deadline

    def _send(self, payload: bytes) -> list[CanFrame]:
        return self._send_all(self._on_bus(payload))

    def _on_bus(self, payload: bytes) -> list[tuple[int, bytes]]:
        return self._drive.commands(payload) if self._drive else [(COMMAND_ID, payload)]

    def _send_all(self, messages: list[tuple[int, bytes]]) -> list[CanFrame]:
        stamp = self._epoch_ns + time.monotonic_ns()
        try:
            for number, data in messages:
                self._bus.send(_message(number, data))
        except (can.CanError, OSError) as error:
            self._fail(f"a command could not be sent: {error}", error)
        return [CanFrame(stamp, number, data) for number, data in messages]

    def _send_zero(self) -> None:
        for number, data in self._on_bus(ZERO):
            with suppress(can.CanError, OSError):
                self._bus.send(_message(number, data))

    def _receive(self, frames: list[CanFrame], timeout: float) -> bool:
        try:
            message = self._bus.recv(timeout)
        except (can.CanError, OSError) as error:
            self._fail(f"receiving failed: {error}", error)
        if message is None:
            return False
        if message.is_error_frame or message.is_remote_frame or message.is_extended_id:
            return True
        now = time.monotonic_ns()
        if message.arbitration_id in self._heard:
            self._heard[message.arbitration_id] = now
        stamp = self._epoch_ns + now
        frames.append(CanFrame(stamp, message.arbitration_id, bytes(message.data)))
        return True

    def _drain(self, frames: list[CanFrame]) -> None:
        for _ in range(BACKLOG):
            if not self._receive(frames, 0.0):
                return

    def _watch(self, now: int) -> None:
        for motor, heard in zip(MOTORS, self._heard.values(), strict=True):
            if now - heard > self._silence_ns:
                silent = (now - heard) / 1e6
                self._fail(f"no feedback from motor {motor} for {silent:.0f} ms", None)

    def _fail(self, what: str, cause: Exception | None) -> None:
        self._send_zero()
        raise Stopped(f"{self._bus.channel_info}: {what}", self._frames) from cause


def _message(number: int, data: bytes) -> can.Message:
    return can.Message(arbitration_id=number, data=data, is_extended_id=False)
