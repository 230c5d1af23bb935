"""The model itself behind the robot's interface: for trials without any robot, real or emulated."""

from collections.abc import Mapping

import numpy as np

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
from spirob.control.law import CURRENT
from spirob.control.schedule import Schedule
from spirob.errors import HardwareError
from spirob.plant import Plant, Session
from spirob.robot import CYCLE_NS, MOTORS, Scene

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

    def prepare(self, scene: Scene) -> None:
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
