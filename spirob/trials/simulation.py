"""Trials without any robot: the model played at once, or behind the robot's interface."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace

import numpy as np

from spirob.can.description import RPM
from spirob.can_protocol import (
    AMPERE_PER_COUNT,
    COMMAND_ID,
    COUNTS_PER_TURN,
    FEEDBACK_ID,
    CanFrame,
    Feedback,
    decode_command,
    encode_feedback,
)
from spirob.control import CURRENT, Schedule
from spirob.errors import HardwareError
from spirob.logs.reader import CHANNELS, FILTER_WINDOW, VOLTAGE
from spirob.logs.trace import Trace, moving_average
from spirob.plant import Frames, Plant, Response, Session
from spirob.robot import CYCLE_NS, MOTORS, Scene
from spirob.trials.play import Reaction
from spirob.trials.trial import Trial

ARM_CURRENT = {"arm_current": "A"}  # i** of (17), beside i*
FRAMES = Frames(current=AMPERE_PER_COUNT, speed=1.0 / RPM["rad/s"])  # of `Feedback`: whole rpm


def simulate(
    plant: Plant,
    trial: Trial,
    changes: Mapping[str, float],
    current_noise: float = 0.0,
    seed: int = 0,
    react: Reaction | None = None,
    shots: int = 1,
) -> Trace:
    """The trial as a decoded trace: current in counts of the drive, with sensor noise.

    A loop on the host reads that noise and the drive's counts too, so that every shot is another
    trial.  Without noise it reads exact values: rounding alone is no dither, and does not average.

    current_noise  standard deviation [A];  seed  of the noise;  shots  whose mean the trace is
    react          what the trial does about the current that it feels, which may shorten it
    Raises SimulationError when the model diverges.
    """
    schedule = trial.schedule()
    rng = np.random.default_rng(seed)
    draws = rng.normal(0.0, 1.0, (shots, *schedule.reference.shape)) * current_noise
    if react is not None:
        session = plant.start(trial.scene, changes)
        response, schedule = _reacting(session, schedule, draws[0], react)
        current = _counted(response.current + draws[:, : schedule.cycles]).mean(axis=0)
    elif current_noise and plant.rig.host is not None:
        heard = plant.reading(FRAMES)
        response = _mean([heard.simulate(schedule, trial.scene, changes, noise=d) for d in draws])
        current = response.current
    else:
        response = plant.simulate(schedule, trial.scene, changes)
        current = _counted(response.current + draws).mean(axis=0)
    signals: dict[str, np.ndarray] = {}
    for m, motor in enumerate(MOTORS):
        signals |= {
            f"{motor}.current": current[:, m],
            f"{motor}.current_filtered": moving_average(current[:, m], FILTER_WINDOW, trial.name),
            f"{motor}.displacement": response.displacement[:, m],
            f"{motor}.velocity": response.velocity[:, m],
            f"{motor}.command": response.command[:, m],
            f"{motor}.reference": schedule.reference[:, m],
            f"{motor}.reference_rate": schedule.reference_rate[:, m],
            f"{motor}.mode": np.full(schedule.cycles, float(schedule.mode[m])),
            f"{motor}.arm_current": response.arm_current[:, m],
        }
        if plant.rig.host is not None:
            signals[f"{motor}.voltage"] = response.voltage[:, m]
    units = {
        name: (CHANNELS | VOLTAGE | ARM_CURRENT).get(name.split(".")[1], "") for name in signals
    }
    plain = dict(trial.plain)
    meta = {"role": trial.role, "trial": plain, "scene": plain.get("scene") or {}}
    time = np.arange(schedule.cycles, dtype=np.int64) * CYCLE_NS
    return Trace(trial.name, time, signals, units, meta)


def _reacting(
    session: Session, schedule: Schedule, noise: np.ndarray, react: Reaction
) -> tuple[Response, Schedule]:
    """The answer cycle by cycle where the reaction listens, and the rows that were played."""
    row = min(react.begins, schedule.cycles)
    rows = [np.arange(row)]
    pieces = [session.play(_part(schedule, rows[0]))]
    count = row
    while row < min(react.ends, schedule.cycles):
        row = react(row, _counted(pieces[-1].current[-1] + noise[count]).tolist())
        rows.append(np.arange(row, row + 1 if row < react.ends else schedule.cycles))
        pieces.append(session.play(_part(schedule, rows[-1])))
        row, count = int(rows[-1][-1]) + 1, count + 1
    if row < schedule.cycles:
        rows.append(np.arange(row, schedule.cycles))
        pieces.append(session.play(_part(schedule, rows[-1])))
    # the last row of a piece is the first of the next
    whole = {f.name: [getattr(p, f.name)[:-1] for p in pieces] for f in fields(Response)}
    played = _part(schedule, np.concatenate(rows))
    return Response(**{name: np.concatenate(parts) for name, parts in whole.items()}), played


def _mean(shots: Sequence[Response]) -> Response:
    of = {f.name: [getattr(shot, f.name) for shot in shots] for f in fields(Response)}
    return Response(**{name: np.mean(values, axis=0) for name, values in of.items()})


def _part(schedule: Schedule, rows: np.ndarray) -> Schedule:
    return replace(
        schedule, reference=schedule.reference[rows], reference_rate=schedule.reference_rate[rows]
    )


def _counted(current: np.ndarray) -> np.ndarray:
    return np.round(current / AMPERE_PER_COUNT) * AMPERE_PER_COUNT


ROOM = 25  # °C, reported throughout: the model has no winding temperature
FULL_SCALE = 32767


class SimulatedRobot:
    """A `Robot` computed by the model, quantised to the drive's counts.

    changes  parameters of the model that differ from nominal, by `owner.field`
    """

    def __init__(self, plant: Plant, changes: Mapping[str, float] | None = None):
        self._plant, self._changes = plant, dict(changes or {})
        self._session: Session | None = None
        self._cycle = 0
        self._limit = np.full(len(MOTORS), 20.0)

    def prepare(self, scene: Scene, trial: str = "trial") -> None:
        """Start again at rest in this scene, at time zero."""
        self._session = self._plant.start(scene, self._changes)
        self._cycle = 0

    def exchange(self, command: bytes) -> list[CanFrame]:
        """Play one cycle; raises HardwareError before `prepare`, SimulationError on divergence."""
        if self._session is None:
            raise HardwareError("simulated robot: prepare a scene before the first command")
        currents = np.array([decode_command(command, len(MOTORS))])
        modes = np.full(len(MOTORS), CURRENT)
        schedule = Schedule(modes, currents, np.zeros_like(currents), self._limit)
        response = self._session.play(schedule)
        sent = CanFrame(self._cycle * CYCLE_NS, COMMAND_ID, bytes(command))
        self._cycle += 1
        stamp = self._cycle * CYCLE_NS
        winch = self._plant.rig.winch
        turn = winch.gear_ratio / winch.radius  # rotor angle per wound-in length
        frames = [sent]
        for m in range(len(MOTORS)):
            angle = round(response.displacement[-1, m] * turn / (2 * np.pi) * COUNTS_PER_TURN)
            speed = round(response.velocity[-1, m] * turn * 60 / (2 * np.pi))
            counts = round(response.current[-1, m] / AMPERE_PER_COUNT)
            feedback = Feedback(angle % COUNTS_PER_TURN, _clip(speed), _clip(counts), ROOM)
            frames.append(CanFrame(stamp, FEEDBACK_ID + 1 + m, encode_feedback(feedback)))
        return frames

    def close(self) -> None:
        """Forget the session; safe to call twice."""
        self._session = None


def _clip(value: int) -> int:
    return max(-FULL_SCALE, min(FULL_SCALE, value))
