"""The emulated robot's true shape over a trial, for the report's animation alone.

Drives do not see the arm's shape, so no log holds it and nothing that judges reads it: it lies
beside the truth, and the report draws it on top of the model after the verdict.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from spirob.can_protocol import CanFrame
from spirob.emulator.robot import EmulatedRobot
from spirob.files import replacing
from spirob.robot import CYCLE_NS, Scene

FOLDER = Path("data/truth/posture")
EVERY = 33  # cycles, about 30 frames a second


class WatchedRobot:
    """A `Robot` that notes its hinge angles now and then and is otherwise the emulated one."""

    def __init__(self, robot: EmulatedRobot):
        self._robot = robot
        self._cycles = 0
        self._seen: list[np.ndarray] = []

    def prepare(self, scene: Scene) -> None:
        """As the robot does."""
        self._robot.prepare(scene)

    def exchange(self, command: bytes) -> list[CanFrame]:
        """As the robot does."""
        if self._cycles % EVERY == 0:
            heading = self._robot.machine.state["phi"][0]
            self._seen.append(np.diff(heading, prepend=0.0))
        self._cycles += 1
        return self._robot.exchange(command)

    def close(self) -> None:
        """As the robot does."""
        self._robot.close()

    def write(self, root: Path, trial: str) -> None:
        """data/truth/posture/TRIAL.parquet: trial, time [s], angle of each hinge [rad]."""
        angles = np.array(self._seen)
        columns = {f"q{i}": angles[:, i] for i in range(angles.shape[1])}
        time = np.arange(len(angles)) * EVERY * CYCLE_NS * 1e-9
        table = pd.DataFrame({"trial": trial, "time": time} | columns)
        with replacing(root / FOLDER / f"{trial}.parquet") as temporary:
            table.to_parquet(temporary, compression="zstd", index=False)
