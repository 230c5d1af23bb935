"""Trials played on a robot without steel, recorded and decoded from their logs like any others."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

from spirob.bench import Trial, record
from spirob.emulator import EmulatedRobot
from spirob.identify.measurement import Measurement
from spirob.logs import Transmission, read_log
from spirob.plant import Rig
from spirob.robot import Robot, Scene


def recorded(robot: Robot, trials: Sequence[Trial], rig: Rig) -> list[Measurement]:
    """One measurement for each trial; the rig tells gains and transmission."""
    found = []
    with tempfile.TemporaryDirectory(prefix="spirob-recorded-") as folder:
        for trial in trials:
            path = record(
                trial,
                robot,
                Path(folder) / f"{trial.name}.mcap",
                transmission=Transmission(
                    gear_ratio=rig.winch.gear_ratio, winch_radius=rig.winch.radius
                ),
                gains=rig.gains,
                rig=rig.name,
                prepare=lambda scene, name=trial.name: _prepare(robot, scene, name),  # type: ignore[misc]
            )
            found.append(Measurement.from_trace(read_log(path)))
    return found


def _prepare(robot: Robot, scene: Scene, name: str) -> None:
    # an emulated robot's noise belongs to the trial's name
    if isinstance(robot, EmulatedRobot):
        robot.prepare(scene, name)
    else:
        robot.prepare(scene)
