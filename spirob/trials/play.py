"""Plays a trial on a robot, cycle by cycle, and hands everything to the log.

Feedback of cycle k is what came in before its command goes out.  Every command passes the guard of
`can.guard`, and where drives take voltages the current loop on the host, between guard and bus.
However a trial ends - an error, Ctrl-C, SIGTERM, a full disk - the last command is zero current,
sent before the log is closed.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from spirob.can.drive import Drive, Translator
from spirob.can.guard import GuardedRobot
from spirob.can.limits import Limits, interruptible
from spirob.can.motor import MotorState
from spirob.can_protocol import encode_command, encode_volts
from spirob.control import CYCLE, Gains, HostLoop, Placed, current_command, host_voltage, placed
from spirob.errors import ConfigError, HardwareError
from spirob.logs.cycles import Transmission
from spirob.logs.writer import ThreadedLog, TrialLog
from spirob.robot import CYCLE_NS, MOTORS, Robot
from spirob.trials.trial import Trial

if TYPE_CHECKING:
    from spirob.plant import Rig


class HostCurrentLoop:
    """u = u_ff + u_fb of (12), (13), once a cycle, by what each motor last said.

    A motor that has said nothing new keeps its feedback part: the integral does not count one
    reading twice, and the guard stops the trial after 10 ms.

    loop, resistance [Ω], inductance [H], emf_constant [V·s/rad]   what the host believes, of the
                         back-EMF as much as it feeds forward
    limit                of a voltage [V]
    rotor_per_velocity   rotor speed over tendon speed [rad/m], G/r
    Raises ConfigError where the gains are unstable.
    """

    def __init__(
        self,
        loop: HostLoop,
        resistance: float,
        inductance: float,
        emf_constant: float,
        limit: float,
        rotor_per_velocity: float,
    ):
        self.placed: Placed = placed(loop, resistance, inductance)
        self._motor = (resistance, inductance, emf_constant)
        self._limit, self._turn = limit, rotor_per_velocity
        self.begin()

    @classmethod
    def of(cls, rig: "Rig", limit: float) -> "HostCurrentLoop | None":
        """The loop of a rig that closes it on the host, None of any other; limit [V]."""
        if rig.host is None:
            return None
        motor, winch = rig.motor, rig.winch
        most = min(limit, rig.drive.voltage_limit)
        emf = rig.drive.emf_compensation * motor.emf_constant
        turn = winch.gear_ratio / winch.radius
        return cls(rig.host, motor.resistance, motor.inductance, emf, most, turn)

    def begin(self) -> None:
        """Forget the trial before."""
        self._integral = [0.0] * len(MOTORS)
        self._command: list[float | None] = [None] * len(MOTORS)
        self._error = [0.0] * len(MOTORS)
        self._heard = [-1] * len(MOTORS)

    def __call__(self, currents: Sequence[float], states: Sequence[MotorState]) -> bytes:
        """The payload of voltages for the currents [A] that are asked for."""
        volts = [self._volts(m, currents[m], state) for m, state in enumerate(states)]
        return encode_volts(tuple(volts))

    def _volts(self, m: int, command: float, state: MotorState) -> float:
        fresh = state.heard_ns != self._heard[m]
        before = self._command[m]
        if before is None:
            before, self._error[m] = 0.0, command - state.current
        voltage, integral, error = host_voltage(
            command,
            before,
            state.current,
            self._error[m],
            state.velocity * self._turn,
            self._integral[m],
            CYCLE,
            *self._motor,
            *self.placed.gains,
            self._limit,
        )
        self._command[m] = command
        if fresh:
            self._integral[m], self._error[m], self._heard[m] = integral, error, state.heard_ns
        return voltage


def require_fitting(drive: Drive | None, loop: object | None) -> None:
    """Raises ConfigError where a drive takes voltages and nothing makes them, or the other way."""
    if loop and not (drive and drive.by_voltage):
        name = drive.about.name if drive else "c620"
        raise ConfigError(
            f"drive '{name}' has no voltage mode, which drive.loop: host needs; gm6020 has one"
        )
    if drive and drive.by_voltage and not loop:
        raise ConfigError(
            f"drive '{drive.about.name}' takes voltages: it needs rig.drive.loop: host"
        )


class Reaction(Protocol):
    """Asked before each cycle whose row lies from `begins` to before `ends`.

    It is made anew for every trial that is played.
    """

    begins: int
    ends: int

    def __call__(self, row: int, currents: Sequence[float]) -> int:
        """The row to be played instead of `row`, most often the same.

        currents  that the motors last reported [A]
        """


ZERO = encode_command((0.0,) * len(MOTORS))
FIRST_ANSWER = 100  # cycles a drive may take until its first feedback
PERIOD = CYCLE_NS / 1e9


@runtime_checkable
class Timed(Protocol):
    """A robot in real time, which knows how its loop kept its deadlines; it does not wait."""

    def timing(self) -> dict[str, str]:
        """Lateness and what it was due to, as text for the log."""


def record(
    trial: Trial,
    robot: Robot,
    path: Path | str,
    rig: "Rig",
    *,
    config: bytes = b"",
    about: Mapping[str, str] | None = None,
    limits: Limits | None = None,
    drive: Drive | None = None,
    react: Reaction | None = None,
    loop: HostCurrentLoop | None = None,
) -> Path:
    """Prepare the scene, arm, play the trial and write its log; the finished log's path.

    rig      tells gains and transmission
    limits   of the guard that is put around the robot
    drive    what the robot's drives are where they are not C620-style
    loop     closes the current loop on the host, of drives that take voltages
    See `TrialLog` for config and about, `play` for the rest.
    """
    transmission = Transmission(gear_ratio=rig.winch.gear_ratio, winch_radius=rig.winch.radius)
    guarded = guard(robot, transmission, limits, drive, loop)
    if loop:
        about = {**(about or {}), "host_loop": loop.placed.told()}
    kind = ThreadedLog if isinstance(robot, Timed) else TrialLog
    log = kind(
        path,
        trial=trial.plain,
        transmission=transmission,
        rig=rig.name,
        config=config,
        about=about,
        drive=drive,
    )
    robot.prepare(trial.scene, trial.name)
    guarded.arm()
    with log:
        try:
            play(trial, guarded, log, gains=rig.gains, react=react)
        finally:
            if isinstance(robot, Timed):
                log.timing = robot.timing()
    return log.path


def guard(
    robot: Robot,
    transmission: Transmission,
    limits: Limits | None = None,
    drive: Drive | None = None,
    loop: HostCurrentLoop | None = None,
) -> GuardedRobot:
    """The robot behind limits, in metres at its tendons; not yet armed.

    Raises ConfigError where the drive takes voltages and there is no loop, or the other way round.
    """
    require_fitting(drive, loop)
    scale = (transmission.metre_per_count, transmission.metre_per_second_per_rpm)
    guarded = GuardedRobot(robot, limits or Limits(), *scale, loop=loop)
    if drive:
        guarded.interpret = Translator(drive)
    return guarded


def play(
    trial: Trial,
    robot: GuardedRobot,
    log: TrialLog,
    *,
    gains: Gains,
    react: Reaction | None = None,
) -> None:
    """Play a trial on a prepared and armed robot.

    react  what the trial does about what it feels
    Raises what the robot raises, HardwareError where a drive never answers; the command is zero.
    """
    robot.keep = log.frames
    try:
        with interruptible() as check:
            _play(trial, robot, log, gains, check, react)
    except BaseException:
        robot.stop()
        raise
    robot.keep = lambda frames: None
    robot.finish()


def _play(
    trial: Trial,
    robot: GuardedRobot,
    log: TrialLog,
    gains: Gains,
    check: Callable[[], None],
    react: Reaction | None,
) -> None:
    schedule = trial.schedule()
    states = robot.states
    _first_answers(robot, check)

    # Plain floats and local names: this loop has a millisecond, and shares it with the bus.
    modes, limits = schedule.mode.tolist(), schedule.current_limit.tolist()
    integrals = [0.0] * len(MOTORS)
    per_ampere, drag = gains.newton_per_ampere, gains.drag
    law = (gains.velocity, gains.integral, gains.displacement, gains.force, per_ampere, drag)
    asked = list(zip(schedule.reference.tolist(), schedule.reference_rate.tolist(), strict=True))
    k = 0
    while k < len(asked):
        check()
        if react and react.begins <= k < react.ends:
            k = react(k, [state.current for state in states])
        references, rates = asked[k]
        currents = []
        for m, state in enumerate(states):
            current, integrals[m] = current_command(
                modes[m],
                references[m],
                rates[m],
                state.displacement,
                state.velocity,
                state.current,
                integrals[m],
                PERIOD,
                limits[m],
                *law,
            )
            currents.append(current)
        positions = [s.displacement for s in states]
        velocities = [s.velocity for s in states]
        efforts = [per_ampere * s.current - drag * s.velocity for s in states]
        frames = robot.exchange(encode_command(tuple(currents)))
        log.cycle(
            frames[0].stamp_ns,
            positions,
            velocities,
            efforts,
            currents,
            references,
            rates,
            modes,
        )
        k += 1


def _first_answers(robot: GuardedRobot, check: Callable[[], None]) -> None:
    """Command zero until every drive has answered; length counts from its last answer."""
    for _ in range(FIRST_ANSWER):
        check()
        robot.exchange(ZERO)
        if all(state.answered for state in robot.states):
            for state in robot.states:
                state.start_here()
            return
    silent = [m for m, state in zip(MOTORS, robot.states, strict=True) if not state.answered]
    raise HardwareError(f"no feedback from motor {' and '.join(silent)} in {FIRST_ANSWER} cycles")
