"""Plays trials: one on every side, robot, models, single dynamics; or many on one of them.

The trial before a passive experiment tells of a robot on direct drive what its models have to know
(`informed`): its loop's own numbers (`spirob.experiments.host_loop`), and how its arm swings.
Behind a gear it swings too slowly for that to show, so that a fit of the geared machine leaves open
what the hinges lose, and hardly tells a stiffer arm from one with inertia added to its hinges.  On
direct drive both tendons shake the arm, and

    τ_d, k₁, I_a = argmin Σ (v_robot - v_model(τ_d, k₁, I_a))²

over both tendons' speeds.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np
from joblib import Parallel, delayed
from scipy.optimize import least_squares

from pipeline.robots import build, drive_of, loop_of
from pipeline.schema import Config
from pipeline.stage import HIDDEN, public_config, read_json, read_yaml, workers
from spirob.control import FORCE
from spirob.effects import find_effects
from spirob.emulator.robot import EmulatedRobot
from spirob.ending import end_with_parent
from spirob.experiments import BLOCK, BUILT, Experiment, Play, Side, repeating
from spirob.identify.builds import TOLERANCES, anew
from spirob.logs import read_log
from spirob.plant import Plant, Rig
from spirob.plant.plant import single_dynamics
from spirob.robot import MOTORS
from spirob.trials import Trial, record
from spirob.trials.simulation import simulate

# which effects the model has and which numbers are not nominal: `{effects: [...], changes: {...}}`
Models = Mapping[str, Mapping[str, Any]]
# of a build: how stiff the arm is, its swing tells
UNTOLD = {name: width for name, width in TOLERANCES.items() if not name.startswith("arm.")}


@dataclass(frozen=True)
class Stand:
    """What a trial of this project is played on: its robot, and the model with the named effect.

    plain   the public configuration;  hidden  what only an emulated robot knows
    """

    root: Path
    plain: dict[str, Any]
    hidden: dict[str, Any]
    named: Mapping[str, Any]

    @classmethod
    def of(cls, root: Path) -> "Stand":
        """That of a project's folder, once the stage `decide` has named an effect."""
        config = public_config(root)
        hidden = read_yaml(root / HIDDEN, "config") or {}
        named = read_json(root / "data/diagnosis/model.json", "decide")
        return cls(root, config.model_dump(), hidden, named)

    @property
    def config(self) -> Config:
        """As an object."""
        return Config.model_validate(self.plain)

    def robot(self, play: Play, logs: Path) -> Side:
        """The robot's answer; its log goes into a folder under the root."""
        return robot_side(self.config, self.hidden, play, self.root / logs / f"{play.name}.mcap")

    def model(self, play: Play, noise: float, seed: int) -> Side:
        """The model's, with sensor noise [A]."""
        return model_side(self.config, play, self.named, noise, seed)

    def each(self, act: Callable[..., Side], given: Iterable[Sequence[Any]]) -> list[Side]:
        """`robot` or `model` for all that is given, on all cores."""
        run = Parallel(n_jobs=workers(), initializer=end_with_parent)
        return list(run([delayed(act)(*one) for one in given]))


def play_all(
    config: Config, hidden: Mapping[str, Any], play: Play, models: Models, log: Path
) -> dict[str, Side]:
    """Every side's answer to one trial.

    log  where the robot's log goes; real hardware is not driven, so that side is then left out
    """
    rig = Rig.from_mapping(merged(config.rig, play.rig))
    trial = Trial.from_plain(play.trial)
    if play.built is not None:
        return {BUILT: _mean(play, partial(_of_model, config, models["named"]))}
    sides: dict[str, Side] = {}
    if config.robot.kind != "can" and _plays("robot", play):
        sides["robot"] = _mean(play, partial(_on_robot, config, hidden, log))
    for name, model in models.items():
        if _plays(name, play):
            sides[name] = _mean(play, partial(_of_model, config, model))
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


def _noise(config: Config, play: Play) -> tuple[float, int]:
    """The sensor's noise [A] where a model has it, and its seed."""
    size = getattr(config.robot, "current_noise", 0.0) if play.noisy else 0.0
    return size, crc32(play.name.encode()) + play.first


def _mean(play: Play, block: Callable[[Play], Side]) -> Side:
    """What one side did, the mean of all blocks of shots."""
    if play.shots == 1:
        return block(play)
    firsts = range(play.first, play.first + play.shots, BLOCK)
    return Side.mean([block(replace(play, shots=BLOCK, first=first)) for first in firsts])


def _of_model(config: Config, model: Mapping[str, Any], play: Play) -> Side:
    """What a model did, with noise where the play is noisy."""
    return model_side(config, play, model, *_noise(config, play))


def _on_robot(config: Config, hidden: Mapping[str, Any], log: Path, play: Play) -> Side:
    """What a robot did, the mean of all shots."""
    if play.shots == 1:
        return robot_side(config, hidden, play, log)
    sides = []
    for k in range(play.first, play.first + play.shots):
        name = f"{play.name}_{k}"
        shot = replace(play, name=name, trial={**play.trial, "name": name})
        sides.append(robot_side(config, hidden, shot, log.with_name(f"{name}.mcap")))
    return replace(Side.mean(sides), parts=())


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

    try:
        path = record(
            trial,
            robot,
            log,
            rig,
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
    """What a model did: its current in counts of the drive, with sensor noise [A] where asked.

    It has what is known of the robot beside what the model says.
    """
    rig = Rig.from_mapping(merged(merged(config.rig, play.rig), play.known.rig))
    trial, plant = Trial.from_plain(play.trial), Plant(rig, find_effects(model["effects"]))
    known = set(plant.table.names)
    changes = {k: v for k, v in model["changes"].items() if k in known} | play.known.changes
    if play.built is not None:
        plant, changes = anew(plant, changes, np.random.default_rng(play.built), UNTOLD)
    react = play.react() if play.react else None
    return Side.from_trace(simulate(plant, trial, changes, noise, seed, react, play.shots))


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


SWING = {  # what the arm's swing tells -> within which bounds
    "damping_time": (2e-3, 0.2),  # s
    "base_stiffness": (0.01, 2.0),  # N·m/rad
    "armature": (1e-6, 1e-3),  # kg·m²; the tip wants more than two steps a cycle with less
}
CLOSE = 1e-3  # of the sum of squares, from one step of the fit to the next
NUDGE = 1e-2  # of the number, for a derivative
TRIES = 20  # of a step


def informed(
    config: Config, hidden: Mapping[str, Any], experiment: Experiment, models: Models, logs: Path
) -> tuple[Experiment, Models]:
    """Experiment and models with what the robot's trial has told; hardware is not driven."""
    first = experiment.before()
    if first is None or config.robot.kind == "can":
        return experiment, models
    side = robot_side(config, hidden, first, logs / f"{first.name}.mcap")
    experiment = experiment.informed(side)
    again = experiment.before() or first
    return experiment, {name: swinging(config, again, m, side) for name, m in models.items()}


def swinging(config: Config, play: Play, model: Mapping[str, Any], robot: Side) -> dict[str, Any]:
    """A model with the arm's numbers under which its tendons move as the robot's in this trial."""
    arm = Rig.from_mapping(merged(config.rig, play.rig)).arm
    begin = [model["changes"].get(f"arm.{name}", getattr(arm, name)) for name in SWING]
    low, high = np.array(list(SWING.values())).T

    def moved(logs: np.ndarray) -> dict[str, Any]:
        found = {f"arm.{name}": float(v) for name, v in zip(SWING, np.exp(logs), strict=True)}
        return {**model, "changes": {**model["changes"], **found}}

    def apart(logs: np.ndarray) -> np.ndarray:
        return (model_side(config, play, moved(logs)).velocity - robot.velocity).ravel()

    found = least_squares(
        apart,
        np.log(np.clip(begin, low, high)),
        bounds=(np.log(low), np.log(high)),
        diff_step=NUDGE,
        ftol=CLOSE,
        max_nfev=TRIES,
    )
    return moved(found.x)
