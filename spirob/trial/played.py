"""A robot with something hidden plays the trial's bends over the bus; its logs are decoded."""

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from spirob.bench import Trial, record
from spirob.diagnosis.rungs import ROLES
from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.emulator.robot import EmulatedRobot
from spirob.identify.measurement import Measurement
from spirob.identify.residual import Residual
from spirob.logs import read_log
from spirob.logs.transmission import Transmission
from spirob.plant import Plant, Rig
from spirob.robot import Scene
from spirob.trial.bends import bends


def recorded(
    hidden: HiddenSettings, seed: int, trials: Sequence[Mapping[str, Any]] | None = None
) -> dict[str, list[Measurement]]:
    """Play trials over the bus, the bends where none are given, and decode their logs."""
    rig = Rig()
    machine = EmulatedRig(
        gear_ratio=rig.winch.gear_ratio,
        winch_radius=rig.winch.radius,
        gravity=(rig.arm.gravity_x, rig.arm.gravity_y),
        current_bandwidth=rig.drive.bandwidth,
    )
    robot = EmulatedRobot(machine, hidden, seed)
    found: dict[str, list[Measurement]] = {role: [] for role in ROLES}
    try:
        with tempfile.TemporaryDirectory(prefix="spirob-trial-") as folder:
            for plain in bends() if trials is None else trials:
                path = Path(folder) / f"{plain['name']}.mcap"
                _record(robot, Trial.from_plain(plain), path, rig)
                found[plain["role"]].append(Measurement.from_trace(read_log(path)))
    finally:
        robot.close()
    return found


def _record(robot: EmulatedRobot, trial: Trial, path: Path, rig: Rig) -> None:
    def prepare(scene: Scene) -> None:
        robot.prepare(scene, trial.name)

    record(
        trial,
        robot,
        path,
        transmission=Transmission(gear_ratio=rig.winch.gear_ratio, winch_radius=rig.winch.radius),
        gains=rig.gains,
        rig=rig.name,
        prepare=prepare,
    )


def problems_of(trials: dict[str, list[Measurement]], plant: Plant) -> dict[str, Residual]:
    """What the fit, the search's decision and the final figure compare."""
    return {role: Residual(plant, of, workers=1) for role, of in trials.items()}
