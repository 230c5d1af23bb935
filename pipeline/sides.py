"""Plays one trial of an experiment on every side: robot, model, named model, single dynamics."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.robots import build, drive_of, loop_of
from pipeline.schema import Config
from spirob.bench import Trial, record
from spirob.bench.simulate import simulate
from spirob.control.law import FORCE
from spirob.effects import find_effects
from spirob.emulator.robot import EmulatedRobot
from spirob.experiments import Play, Side
from spirob.experiments.experiment import repeating
from spirob.logs import read_log
from spirob.logs.transmission import Transmission
from spirob.plant import Plant, Rig
from spirob.plant.single import single_dynamics
from spirob.robot import MOTORS, Scene

# which effects the model has and which numbers are not nominal: `{effects: [...], changes: {...}}`
Models = Mapping[str, Mapping[str, Any]]


def play_all(
    config: Config, hidden: Mapping[str, Any], play: Play, models: Models, log: Path
) -> dict[str, Side]:
    """Every side's answer to one trial.

    log  where the robot's log goes; real hardware is not driven, so that side is then left out
    """
    rig = Rig.from_mapping(merged(config.rig, play.rig))
    trial = Trial.from_plain(play.trial)
    sides: dict[str, Side] = {}
    if config.robot.kind != "can" and _plays("robot", play):
        sides["robot"] = robot_side(config, hidden, play, log)
    for name, model in models.items():
        if _plays(name, play):
            sides[name] = model_side(config, play, model)
            if play.repeat and "robot" in sides:
                moved = replace(play, react=partial(play.repeat, sides["robot"]))
                sides[repeating(name)] = model_side(config, moved, model)
    if _plays("single", play):
        sides["single"] = _single(rig, trial, models["base"], sides)
    return sides


def merged(rig: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """A rig with some numbers of its parts replaced."""
    out = dict(rig)
    for part, numbers in changes.items():
        out[part] = {**out.get(part, {}), **numbers}
    return out


def _plays(side: str, play: Play) -> bool:
    return not play.only or side in play.only


def robot_side(
    config: Config,
    hidden: Mapping[str, Any],
    play: Play,
    log: Path,
    moved: Mapping[str, np.ndarray] | None = None,
) -> Side:
    """What an emulated or simulated robot did, from its log.

    moved  factors of an emulated robot's own numbers, for a twin of it that is not quite the same
    """
    rig, trial = Rig.from_mapping(merged(config.rig, play.rig)), Trial.from_plain(play.trial)
    robot = build(config, rig, hidden)
    if moved and isinstance(robot, EmulatedRobot):
        robot.machine.move(moved)

    def prepare(scene: Scene) -> None:
        if isinstance(robot, EmulatedRobot):
            robot.prepare(scene, trial.name)
        else:
            robot.prepare(scene)

    try:
        path = record(
            trial,
            robot,
            log,
            transmission=Transmission(
                gear_ratio=rig.winch.gear_ratio, winch_radius=rig.winch.radius
            ),
            gains=rig.gains,
            rig=rig.name,
            prepare=prepare,
            drive=drive_of(config, rig),
            loop=loop_of(config, rig),
            react=play.react() if play.react else None,
        )
    finally:
        robot.close()
    return Side.from_trace(read_log(path))


def model_side(
    config: Config, play: Play, model: Mapping[str, Any], noise: float = 0.0, seed: int = 0
) -> Side:
    """What a model did: its current in counts of the drive, with sensor noise [A] where asked."""
    rig, trial = Rig.from_mapping(merged(config.rig, play.rig)), Trial.from_plain(play.trial)
    plant = Plant(rig, find_effects(model["effects"]))
    known = set(plant.table.names)
    changes = {k: v for k, v in model["changes"].items() if k in known}
    react = play.react() if play.react else None
    return Side.from_trace(simulate(plant, trial, changes, noise, seed, react))


def _single(rig: Rig, trial: Trial, base: Mapping[str, Any], sides: Mapping[str, Side]) -> Side:
    """The arm alone, with the numbers of the base model.

    It takes forces only: the commanded one, or nominal n times the current that was commanded.
    """
    arm = {k.partition(".")[2]: v for k, v in base["changes"].items() if k.startswith("arm.")}
    bare = Rig(
        name=rig.name,
        geometry=rig.geometry,
        cut=rig.cut,
        arm=replace(rig.arm, **arm),  # type: ignore[type-var]
    )
    played = sides.get("robot", sides["base"]).command[: trial.cycles]
    schedule = trial.schedule(len(played))
    force = rig.gains.newton_per_ampere * played
    for m in range(len(MOTORS)):
        if schedule.mode[m] == FORCE:
            force[:, m] = schedule.reference[:, m]
    return Side.from_motion(single_dynamics(bare, np.maximum(force, 0.0), trial.scene), played)
