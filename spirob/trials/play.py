"""Plays a trial on a robot, cycle by cycle, and hands everything to the log.

Feedback of cycle k is what came in before its command goes out.  Every command passes the guard of
`spirob.safety`.  However a trial ends - an error, Ctrl-C, SIGTERM, a full disk - the last command
is zero current, sent before the log is closed.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Protocol, runtime_checkable

from spirob.can_protocol import encode_command
from spirob.control.law import Gains, current_command
from spirob.drives import Drive, Translator
from spirob.errors import HardwareError
from spirob.logs.cycles import Transmission
from spirob.logs.writer import ThreadedLog, TrialLog
from spirob.robot import CYCLE_NS, MOTORS, Robot, Scene
from spirob.safety import GuardedRobot, Limits, interruptible
from spirob.trials.host import HostCurrentLoop, require_fitting
from spirob.trials.trial import Trial


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
PROGRESS_EVERY = 500  # cycles
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
    *,
    transmission: Transmission,
    gains: Gains,
    rig: str,
    config: bytes = b"",
    about: Mapping[str, str] | None = None,
    progress: Callable[[float], None] | None = None,
    prepare: Callable[[Scene], None] | None = None,
    limits: Limits | None = None,
    drive: Drive | None = None,
    react: Reaction | None = None,
    loop: HostCurrentLoop | None = None,
) -> Path:
    """Prepare the scene, arm, play the trial and write its log; the finished log's path.

    prepare  instead of the robot's own `prepare`, where that needs more than the scene
    limits   of the guard that is put around the robot
    drive    what the robot's drives are where they are not C620-style
    loop     closes the current loop on the host, of drives that take voltages
    See `TrialLog` for rig, config and about, `play` for the rest.
    """
    guarded = guard(robot, transmission, limits, drive, loop)
    if loop:
        about = {**(about or {}), "host_loop": loop.placed.told()}
    kind = ThreadedLog if isinstance(robot, Timed) else TrialLog
    log = kind(
        path,
        trial=trial.plain,
        transmission=transmission,
        rig=rig,
        config=config,
        about=about,
        drive=drive,
    )
    (prepare or robot.prepare)(trial.scene)
    guarded.arm()
    with log:
        try:
            play(trial, guarded, log, gains=gains, progress=progress, react=react)
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
    progress: Callable[[float], None] | None = None,
    react: Reaction | None = None,
) -> None:
    """Play a trial on a prepared and armed robot.

    progress  called now and then with the fraction done
    react     what the trial does about what it feels
    Raises what the robot raises, HardwareError where a drive never answers; the command is zero.
    """
    robot.keep = log.frames
    try:
        with interruptible() as check:
            _play(trial, robot, log, gains, progress, check, react)
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
    progress: Callable[[float], None] | None,
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
        if progress and k % PROGRESS_EVERY == 0:
            progress(k / schedule.cycles)
        k += 1
    if progress:
        progress(1.0)


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
