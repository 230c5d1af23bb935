"""A robot of one line of physics: each winch follows its current with a first-order lag."""

from math import pi

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
from spirob.logs.cycles import Transmission
from spirob.robot import CYCLE_NS, Scene

SPEED_PER_AMPERE = 40.0  # rotor rad/s, at rest
LAG = 0.05  # s
FIRST_ANGLE = 8000  # so that the angle wraps soon


class FakeRobot:
    """Deterministic; keeps every command, and can be told to fail at one exchange."""

    def __init__(self, fail_at: int | None = None, error: BaseException | None = None):
        self.transmission = Transmission()
        self.commands: list[tuple[float, ...]] = []
        self.displacements: list[tuple[float, ...]] = []
        self.fail_at, self.error = fail_at, error
        self.now_ns = 0
        self.speed = [0.0, 0.0]
        self.angle = [0.0, 0.0]
        self.closed = False

    def prepare(self, scene: Scene, trial: str = "trial") -> None:
        self.scene = scene

    def exchange(self, command: bytes) -> list[CanFrame]:
        currents = decode_command(command)
        self.commands.append(currents)
        if len(self.commands) == self.fail_at and self.error:
            raise self.error
        frames = [CanFrame(self.now_ns, COMMAND_ID, command)]
        for m, current in enumerate(currents):
            self.speed[m] += (SPEED_PER_AMPERE * current - self.speed[m]) * 1e-3 / LAG
            self.angle[m] += self.speed[m] * 1e-3
            data = encode_feedback(
                Feedback(
                    angle=(FIRST_ANGLE + round(self.angle[m] / (2 * pi) * COUNTS_PER_TURN))
                    % COUNTS_PER_TURN,
                    speed=round(self.speed[m] * 60 / (2 * pi)),
                    current=round(current / AMPERE_PER_COUNT),
                    temperature=25 + m,
                )
            )
            stamp = self.now_ns + 900_000 + 130_000 * m // 2
            frames.append(CanFrame(stamp, FEEDBACK_ID + 1 + m, data))
        per_radian = self.transmission.winch_radius / self.transmission.gear_ratio
        self.displacements.append(tuple(a * per_radian for a in self.angle))
        self.now_ns += CYCLE_NS
        return frames

    def close(self) -> None:
        self.closed = True
