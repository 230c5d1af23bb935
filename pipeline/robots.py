"""Build the robot that a configuration names, and record trials on it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import yaml
from joblib import Parallel, delayed

from pipeline.schema import Config
from pipeline.stage import tell, workers
from spirob.can.bus import open_bus
from spirob.can.drive import Drive, find_drive, require_fast_enough
from spirob.can.limits import Limits
from spirob.can.robot import CanRobot
from spirob.can_protocol import CanFrame
from spirob.effects import find_effects
from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.emulator.robot import EmulatedRobot
from spirob.ending import end_with_parent
from spirob.errors import ConfigError
from spirob.files import replacing
from spirob.logs.writer import git_commit, versions
from spirob.plant import Plant, Rig
from spirob.robot import CYCLE_NS, Robot, Scene
from spirob.trials import Trial, record
from spirob.trials.play import HostCurrentLoop, require_fitting
from spirob.trials.simulation import SimulatedRobot

RAW = Path("data/raw")
BY_VOLTAGE = "gm6020"  # what an emulated robot has where it takes voltages


def record_all(
    root: Path,
    config: Config,
    hidden: Mapping[str, Any],
    trials: Sequence[dict[str, Any]],
    folder: Path = RAW,
) -> dict[str, Any]:
    """Record trials into a folder, in parallel where no hardware is involved.

    Returns what an emulated robot really is, for scoring; empty for the others.
    """
    jobs = [delayed(_record)(root, config.model_dump(), dict(hidden), t, folder) for t in trials]
    count = 1 if config.robot.kind == "can" else workers()
    found = Parallel(n_jobs=count, initializer=end_with_parent)(jobs)
    return next((truth for truth in found if truth), {})


def _record(
    root: Path,
    plain: dict[str, Any],
    hidden: dict[str, Any],
    trial_plain: dict[str, Any],
    folder: Path,
) -> dict[str, Any]:
    config = Config.model_validate(plain)
    trial, rig = Trial.from_plain(trial_plain), Rig.from_mapping(config.rig)
    limits = Limits.from_mapping(config.robot.safety)
    assert isinstance(limits, Limits)
    robot = build(config, rig, hidden)
    watched = WatchedRobot(robot) if isinstance(robot, EmulatedRobot) else None

    about = {"commit": git_commit(root), **versions()}
    try:
        record(
            trial,
            watched or robot,
            root / folder / f"{trial.name}.mcap",
            rig,
            config=yaml.safe_dump(config.public(), sort_keys=False).encode(),
            about=about,
            limits=limits,
            drive=drive_of(config, rig),
            loop=loop_of(config, rig, limits),
        )
    finally:
        robot.close()
    if watched and trial.role == "heldout":
        watched.write(root, trial.name)
    tell(f"recorded {trial.name} ({trial.duration:g} s)")
    return robot.truth() if isinstance(robot, EmulatedRobot) else {}


def build(config: Config, rig: Rig, hidden: Mapping[str, Any]) -> Robot:
    """The robot that the configuration names."""
    robot = config.robot
    if robot.kind == "emulated":
        if not hidden:
            raise ConfigError("data/config/hidden.yaml is empty, but the robot is emulated")
        machine = EmulatedRig(
            gear_ratio=rig.winch.gear_ratio,
            winch_radius=rig.winch.radius,
            geometry=rig.geometry,
            gravity=(rig.arm.gravity_x, rig.arm.gravity_y),
            current_bandwidth=rig.drive.bandwidth,
            current_noise=robot.current_noise,
            by_voltage=rig.host is not None,
        )
        effect = HiddenSettings(
            str(hidden["effect"]),
            float(hidden["strength"]),
            str(hidden["build"]),
            hidden.get("built"),
        )
        return EmulatedRobot(machine, effect, int(hidden["seed"]), robot.faults)
    if robot.kind == "simulated":
        return SimulatedRobot(Plant(rig, find_effects(robot.effects)), robot.changes)
    bus = open_bus(robot.interface, robot.channel, robot.bitrate, **robot.options)
    silence_ns = round(1e9 * Limits(**robot.safety).silence)
    return CanRobot(bus, silence_ns=silence_ns, drive=drive_of(config, rig), urgent=True)


def drive_of(config: Config, rig: Rig) -> Drive | None:
    """What the robot's drives are; None for C620-style ones.

    Where the host closes the current loop an emulated robot's are GM6020-style.  Raises ConfigError
    where drive and loop do not fit, or the bus is too slow for them.
    """
    robot, drive = config.robot, None
    if robot.kind == "can":
        drive = find_drive(robot.drive) if robot.drive != "c620" else None
        require_fitting(drive, rig.host)
        if drive and drive.by_voltage:
            require_fast_enough(drive, robot.bitrate)
    elif robot.kind == "emulated" and rig.host is not None:
        drive = find_drive(BY_VOLTAGE)
    return drive


def loop_of(config: Config, rig: Rig, limits: Limits | None = None) -> HostCurrentLoop | None:
    """What closes the current loop on the host; a simulated robot has it inside."""
    if config.robot.kind == "simulated":
        return None
    return HostCurrentLoop.of(rig, (limits or Limits()).voltage)


POSTURE = Path("data/truth/posture")
EVERY = 33  # cycles, about 30 frames a second


class WatchedRobot:
    """A `Robot` that notes its hinge angles now and then and is otherwise the emulated one.

    Drives do not see the arm's shape, so no log holds it and nothing that judges reads it: it lies
    beside the truth, and the report draws it on top of the model after the verdict.
    """

    def __init__(self, robot: EmulatedRobot):
        self._robot = robot
        self._cycles = 0
        self._seen: list[np.ndarray] = []

    def prepare(self, scene: Scene, trial: str = "trial") -> None:
        """As the robot does."""
        self._robot.prepare(scene, trial)

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
        with replacing(root / POSTURE / f"{trial}.parquet") as temporary:
            table.to_parquet(temporary, compression="zstd", index=False)
