"""What only the library knows of a configuration, asked before anything is played or replaced.

Whatever a later stage would refuse for its configuration alone is refused here, with its key.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from pipeline.model import fitted_names
from pipeline.robots import build, drive_of
from pipeline.schema import Config
from pipeline.sides import merged
from pipeline.trials import paper_wraps, recorded_trials, robot_wraps, unseen_wraps
from spirob.campaign.arm.strength import strength_of
from spirob.can.limits import Limits
from spirob.can_protocol import require_known
from spirob.effects import Effect, find_effects
from spirob.emulator.faults import wire_from
from spirob.emulator.hidden import load
from spirob.emulator.rig import HiddenSettings
from spirob.errors import ConfigError, SpirobError
from spirob.experiments import experiment_from
from spirob.identify.residual import Filter
from spirob.logs.reader import FILTER_WINDOW
from spirob.machine.loading import tried
from spirob.perceive.size import SizeSettings
from spirob.perceive.study import require_choices
from spirob.plant import Plant, Rig
from spirob.trials import Trial
from spirob.trials.trial import ROLES, WrapSettings

LEAST_SIZES = 3  # that a stack can learn from


def check(config: Config) -> None:
    """Raises ConfigError naming the key and what is wrong with it."""
    with about("rig"):
        rig = Rig.from_mapping(config.rig)
    _model(config, rig)
    _recordings(config)
    _robot(config, rig)
    _experiments(config)
    _perceive(config)
    _trial(config)


@contextmanager
def about(key: str) -> Iterator[None]:
    """Errors inside are of this key."""
    try:
        yield
    except SpirobError as error:
        said = str(error)
        raise ConfigError(said if said.startswith(key) else f"{key}: {said}") from None


def require_once(names: Sequence[str]) -> None:
    """Raises ConfigError naming what stands twice in a list."""
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        raise ConfigError(f"'{twice[0]}' stands twice")


def _found(names: Sequence[str]) -> list[type[Effect]]:
    """These effects, after files among them were run in a process apart, within bounds of time."""
    for name in names:
        if name.endswith(".py"):
            tried(name, kernel=True)
    return find_effects(list(names))


def _model(config: Config, rig: Rig) -> None:
    with about("plant.effects"):
        require_once(config.plant.effects)
        model = Plant(rig, _found(config.plant.effects))
    with about("diagnose.candidates"):
        require_once(config.diagnose.candidates)
        _found(config.diagnose.candidates)
    with about("identify.parameters"):
        require_once(fitted_names(config))  # those of the model's own effects among them
        for name in config.identify.parameters:
            model.table.position(name)


def _recordings(config: Config) -> None:
    with about("recordings"):
        trials = [Trial.from_plain(t) for t in recorded_trials(config)]
        require_once([t.name for t in trials] + [t["name"] for t in robot_wraps(config)])
        for role in ROLES:
            if role not in {t.role for t in trials}:
                raise ConfigError(f"no trial has the role '{role}'")
        passed = Filter(**config.identify.filter.model_dump())
        for trial in trials:
            where = f"trial '{trial.name}'"
            if trial.cycles < FILTER_WINDOW:
                raise ConfigError(f"{where}: {trial.cycles} ms, but logs need {FILTER_WINDOW}")
            passed(np.zeros(trial.cycles), where)


def _robot(config: Config, rig: Rig) -> None:
    robot = config.robot
    with about("robot.safety"):
        Limits.from_mapping(robot.safety)
    if robot.kind == "can":
        with about("robot"):
            require_known(robot.interface, f"CAN bus {robot.interface}:{robot.channel}")
            drive_of(config, rig)
        return
    if robot.kind == "simulated":
        with about("robot.effects"):
            require_once(robot.effects)
            model = Plant(rig, _found(robot.effects))
        with about("robot.changes"):
            model.table.vector(robot.changes)
        return
    hidden = hidden_of(config)
    with about("robot.faults"):
        wire_from(robot.faults)
    with about("robot.hidden.effect"):
        for kind, _ in HiddenSettings(hidden["effect"], hidden["strength"]).parts:
            load(kind)
    with about("robot"):
        build(config, rig, hidden).close()


def hidden_of(config: Config) -> dict[str, Any]:
    """What only the robot knows; nothing where it is not emulated."""
    if config.robot.kind != "emulated":
        return {}
    if config.robot.hidden is None:
        raise ConfigError("robot.hidden is missing; effect 'none' hides nothing")
    return config.robot.hidden.model_dump() | {"build": config.robot.build}


def _experiments(config: Config) -> None:
    geometry = Rig.from_mapping(config.rig).geometry
    for name, settings in config.paper.items():
        with about(f"paper.{name}"):
            for play in experiment_from(name, settings, geometry).plays():
                Trial.from_plain(play.trial)
                Rig.from_mapping(merged(config.rig, play.rig))


def _perceive(config: Config) -> None:
    perceive = config.perceive
    with about("perceive.wrap"):
        WrapSettings.from_mapping(perceive.wrap)
    with about("perceive.drawn.wrap"):
        WrapSettings.from_mapping(perceive.wrap | perceive.drawn.wrap)
    with about("perceive"):
        SizeSettings.from_mapping(perceive.size)
        require_choices(perceive.choose)
        for wrap in robot_wraps(config) + paper_wraps(config) + unseen_wraps(config):
            Trial.from_plain(wrap)
    if len(set(perceive.diameters)) < LEAST_SIZES:
        raise ConfigError(f"perceive.diameters: a stack learns from {LEAST_SIZES} sizes or more")


def _trial(config: Config) -> None:
    chosen = config.trial
    with about("trial.kinds"):
        for kind in chosen.kinds:
            for part in kind.split("+"):
                strength_of(part, 1.0)
    first, last = chosen.seeds
    if not 0 <= first < last:
        raise ConfigError(f"trial.seeds: from A up to B, 0 <= A < B, not {first} and {last}")
