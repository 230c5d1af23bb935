"""The robot that a controller drives: within limits, armed by hand, zero current first.

Where the drives take voltages, the loop that makes them of currents stands between two limits: of
the currents that are asked for, and of the voltages that go out.  Zero is then zero volts.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Protocol, runtime_checkable

from spirob.can.limits import Limits, Stopped, Watched, of_currents, of_voltages, reason_to_stop
from spirob.can.motor import MotorState
from spirob.can_protocol import FEEDBACK_ID, CanFrame, encode_command
from spirob.errors import HardwareError
from spirob.robot import CYCLE_NS, MOTORS, Robot, Scene

ZERO = encode_command((0.0,) * len(MOTORS))


@runtime_checkable
class Armable(Protocol):
    """A robot that asks before it lets currents flow."""

    def arm(self) -> None:
        """Let currents flow from now on; raises HardwareError where the operator does not agree."""


class CurrentLoop(Protocol):
    """Closes the current loop on the host; `spirob.trials.play` has the one of the paper."""

    def begin(self) -> None:
        """Forget the trial before."""

    def __call__(self, currents: Sequence[float], states: Sequence[MotorState]) -> bytes:
        """The payload of voltages for the currents [A] that are asked for, by what was read."""


class GuardedRobot:
    """A `Robot` around another: no command reaches the drives but through its limits.

    Until `arm` only zero current passes.  When a limit is broken, the bus fails, or the keeping
    of a frame does, zero current is sent first and the guard is disarmed; then the error is raised.

    transmission scale   metres a count of rotor angle, m/s a rpm, for travel and speed
    keep   takes in the frames of every cycle, also of the one that ended in a stop
    interpret   frames of other drives as C620-style ones, the first standing for the command
    loop   of drives that take voltages: makes them of the currents that are asked for
    states   what each motor last said, by position in MOTORS
    """

    def __init__(
        self,
        robot: Robot,
        limits: Limits,
        metre_per_count: float,
        speed_per_rpm: float,
        keep: Callable[[Sequence[CanFrame]], None] = lambda frames: None,
        loop: CurrentLoop | None = None,
    ):
        self.interpret: Callable[[Sequence[CanFrame]], Sequence[CanFrame]] = lambda frames: frames
        self._robot, self._limits, self.keep = robot, limits, keep
        self._scale = (metre_per_count, speed_per_rpm)
        self._loop, self._ending = loop, False
        self.armed = False
        self._reset()

    def _reset(self) -> None:
        self._limiter, self._volts = of_currents(self._limits), of_voltages(self._limits)
        if self._loop:
            self._loop.begin()
        self.states = [MotorState() for _ in MOTORS]
        self._watched: list[Watched] | None = None
        self._stopped = False

    def prepare(self, scene: Scene, trial: str = "trial") -> None:
        """Disarm, and bring the robot to rest in a scene."""
        self.armed = False
        self._reset()
        self._robot.prepare(scene, trial)

    def arm(self) -> None:
        """Let currents flow from now on; a robot with an operator asks for it."""
        if isinstance(self._robot, Armable):
            self._robot.arm()
        self.armed = True

    def exchange(self, command: bytes) -> list[CanFrame]:
        """One cycle within the limits.

        Raises Stopped where a limit is broken, HardwareError where currents are asked for while
        disarmed, and whatever robot or `keep` raise; zero current was then sent before.
        """
        try:
            return self._exchange(command)
        except Stopped as stopped:
            self.stop(stopped.frames)
            raise
        except BaseException:
            self.stop()
            raise

    def finish(self) -> list[CanFrame]:
        """One cycle of zero at the end of a trial: no current asked for, and no voltage."""
        self._ending = True
        try:
            return self.exchange(ZERO)
        finally:
            self._ending = False

    def _exchange(self, command: bytes) -> list[CanFrame]:
        if not self.armed and any(command):
            raise HardwareError("a current was asked for, but the robot is not armed")
        allowed = self._limiter(command)
        self._stopped = False
        frames = self._robot.exchange(self._voltages() if self._loop else allowed)
        reason = self._watch(frames)
        if reason:
            raise Stopped(reason, frames)
        self.keep(frames)
        return frames

    def _voltages(self) -> bytes:
        """What goes out for the currents that passed; none before arming, nor to motors unheard."""
        heard = self.armed and all(state.answered for state in self.states)
        if self._loop is None or not heard or self._ending:
            self._volts.stop()
            return ZERO
        asked = [self._limiter.value(m) for m in range(len(MOTORS))]
        return self._volts(self._loop(asked, self.states))

    def stop(self, frames: Sequence[CanFrame] = ()) -> None:
        """Send zero current at once and disarm, then keep `frames`; never raises an Exception.

        Once stopped, it stays so until the next exchange; a second call does nothing.
        """
        self.armed = False
        if self._stopped:
            return
        self._stopped = True
        self._limiter.stop()
        self._volts.stop()
        if self._loop:
            self._loop.begin()
        kept = list(frames)  # first those that arrived before the stop
        with suppress(Exception):  # the first error is the one to tell
            kept += self._robot.exchange(ZERO)
        with suppress(Exception):
            if frames:
                self.keep(kept)

    def close(self) -> None:
        """Disarm, command zero current and release the bus; safe to call twice."""
        self.armed = False
        self._robot.close()

    def _watch(self, frames: Sequence[CanFrame]) -> str | None:
        now = frames[0].stamp_ns
        if self._watched is None:
            by_voltage = self._loop is not None
            self._watched = [Watched(state, now, by_voltage) for state in self.states]
        for m, motor in enumerate(self._watched):
            motor.command(self._limiter.value(m), self._volts.value(m))
        heard = set()
        for frame in self.interpret(frames):
            m = frame.arbitration_id - FEEDBACK_ID - 1
            if 0 <= m < len(MOTORS) and len(frame.data) == 8:
                state = self.states[m]
                before = state.changed_ns
                state.update(frame.data, frame.stamp_ns, *self._scale)
                watched = self._watched[m]
                if state.changed_ns != before:
                    watched.changed()
                watched.flicker.heard(watched.sent, state.angle, state.current, state.heard_ns)
                heard.add(m)
        for m, motor in enumerate(self._watched):
            reason = reason_to_stop(motor, self._limits, now + CYCLE_NS, m in heard)
            if reason:
                return f"motor {MOTORS[m]}: {reason}; the current is zero"
        return None
