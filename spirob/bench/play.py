"""Plays a trial on a robot, cycle by cycle, and hands everything to the log.

Feedback of cycle k is what came in before its command goes out.  However a trial ends, the last
command is zero current, sent before the log is closed.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from spirob.bench.trial import Trial
from spirob.can_protocol import (
    AMPERE_PER_COUNT,
    COUNTS_PER_TURN,
    FEEDBACK_ID,
    CanFrame,
    decode_feedback,
    encode_command,
)
from spirob.control.law import Gains, current_command
from spirob.errors import HardwareError
from spirob.logs.transmission import HALF_TURN, Transmission
from spirob.logs.writer import TrialLog
from spirob.robot import CYCLE_NS, MOTORS, Robot, Scene

ZERO = encode_command((0.0,) * len(MOTORS))
FIRST_ANSWER = 100  # cycles a drive may take until its first feedback
PROGRESS_EVERY = 500  # cycles
PERIOD = CYCLE_NS / 1e9


class MotorState:
    """What one drive last said, in SI at the tendon, zero length at the start of the trial."""

    __slots__ = ("angle", "answered", "current", "displacement", "turned", "velocity")

    def __init__(self) -> None:
        self.answered = False
        self.angle = self.turned = 0
        self.displacement = self.velocity = self.current = 0.0

    def update(self, data: bytes, metre_per_count: float, speed_per_rpm: float) -> None:
        """Take in one feedback payload."""
        said = decode_feedback(data)
        if self.answered:
            step = said.angle - self.angle
            self.turned += (step + HALF_TURN) % COUNTS_PER_TURN - HALF_TURN
        self.answered = True
        self.angle = said.angle
        self.displacement = self.turned * metre_per_count
        self.velocity = said.speed * speed_per_rpm
        self.current = said.current * AMPERE_PER_COUNT


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
) -> Path:
    """Prepare the scene, play the trial and write its log; the finished log's path.

    prepare  instead of the robot's own `prepare`, where that needs more than the scene
    See `TrialLog` for rig, config and about, `play` for the rest.
    """
    log = TrialLog(
        path,
        trial=trial.plain,
        transmission=transmission,
        rig=rig,
        config=config,
        about=about,
    )
    (prepare or robot.prepare)(trial.scene)
    with log:
        play(trial, robot, log, transmission=transmission, gains=gains, progress=progress)
    return log.path


def play(
    trial: Trial,
    robot: Robot,
    log: TrialLog,
    *,
    transmission: Transmission,
    gains: Gains,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Play a trial on a prepared robot.

    progress  called now and then with the fraction done
    Raises what the robot raises, HardwareError where a drive never answers; the command is zero.
    """
    try:
        _play(trial, robot, log, transmission, gains, progress)
    except BaseException:
        with suppress(Exception):  # the first error is the one to tell
            robot.exchange(ZERO)
        raise
    robot.exchange(ZERO)


def _play(
    trial: Trial,
    robot: Robot,
    log: TrialLog,
    transmission: Transmission,
    gains: Gains,
    progress: Callable[[float], None] | None,
) -> None:
    schedule = trial.schedule()
    states = [MotorState() for _ in MOTORS]
    by_id = {FEEDBACK_ID + 1 + m: state for m, state in enumerate(states)}
    scale = (transmission.metre_per_count, transmission.metre_per_second_per_rpm)
    _first_answers(robot, log, by_id, scale)

    # Plain floats and local names: this loop has a millisecond, and shares it with the bus.
    modes, limits = schedule.mode.tolist(), schedule.current_limit.tolist()
    integrals = [0.0] * len(MOTORS)
    per_ampere, drag = gains.newton_per_ampere, gains.drag
    law = (gains.velocity, gains.integral, gains.displacement, gains.force, per_ampere, drag)
    asked = zip(schedule.reference.tolist(), schedule.reference_rate.tolist(), strict=True)
    for k, (references, rates) in enumerate(asked):
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
        log.frames(frames)
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
        _take_in(frames, by_id, scale)
        if progress and k % PROGRESS_EVERY == 0:
            progress(k / schedule.cycles)
    if progress:
        progress(1.0)


def _first_answers(
    robot: Robot, log: TrialLog, by_id: dict[int, MotorState], scale: tuple[float, float]
) -> None:
    """Command zero until every drive has answered; length counts from its last answer."""
    for _ in range(FIRST_ANSWER):
        frames = robot.exchange(ZERO)
        log.frames(frames)
        _take_in(frames, by_id, scale)
        if all(state.answered for state in by_id.values()):
            for state in by_id.values():
                state.turned, state.displacement = 0, 0.0
            return
    silent = [m for m, state in zip(MOTORS, by_id.values(), strict=True) if not state.answered]
    raise HardwareError(f"no feedback from motor {' and '.join(silent)} in {FIRST_ANSWER} cycles")


def _take_in(
    frames: Sequence[CanFrame], by_id: dict[int, MotorState], scale: tuple[float, float]
) -> None:
    for frame in frames:
        state = by_id.get(frame.arbitration_id)
        if state is not None and len(frame.data) == 8:
            state.update(frame.data, *scale)
