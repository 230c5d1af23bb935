"""Stage `config`: compose conf/ with the overrides of params.yaml, check it, write it resolved.

Two files come out.  data/config/config.yaml is public: every other stage reads it.
data/config/hidden.yaml holds what only the emulated robot knows, and only `collect` reads it.
"""

from pathlib import Path
from typing import Any

import yaml
from hydra import compose, initialize_config_dir
from hydra.errors import HydraException
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException

from pipeline.schema import validated
from pipeline.sides import merged
from pipeline.stage import HIDDEN, PUBLIC, read_yaml, run
from spirob.bench import Trial
from spirob.bench.wrap import WrapSettings
from spirob.effects import find_effects
from spirob.errors import ConfigError
from spirob.experiments import experiment_from
from spirob.logs.atomic import write_text
from spirob.perceive.choice import require_choices
from spirob.perceive.size import SizeSettings
from spirob.plant import Plant, Rig


def stage(root: Path) -> None:
    """Compose, check and split the configuration."""
    params = read_yaml(root / "params.yaml", "a user") or {}
    overrides = params.get("overrides") if isinstance(params, dict) else None
    if not isinstance(overrides, list) or not all(isinstance(o, str) for o in overrides):
        raise ConfigError("params.yaml: 'overrides' must be a list of strings, e.g. ['rig=spirob']")
    write(root, composed(root, overrides), "params.yaml and conf/")


def composed(root: Path, overrides: list[str]) -> Any:
    """conf/ with overrides as plain data; raises ConfigError naming what Hydra did not like."""
    try:
        folder = str((root / "conf").resolve())
        with initialize_config_dir(version_base="1.3", config_dir=folder):
            return OmegaConf.to_container(compose("config", overrides), resolve=True)
    except (HydraException, OmegaConfBaseException) as error:
        said = " ".join(str(error).split())
        raise ConfigError(f"conf/ with overrides {overrides}: {said}") from None


def write(root: Path, plain: Any, source: str) -> None:
    """Check a composed configuration and write its public and its hidden part."""
    config = validated(plain, source)
    check(config.model_dump())
    hidden = {}
    if config.robot.kind == "emulated":
        if config.robot.hidden is None:
            raise ConfigError(f"{source}: robot.hidden is missing; effect 'none' hides nothing")
        hidden = config.robot.hidden.model_dump() | {"build": config.robot.build}
    write_text(root / PUBLIC, yaml.safe_dump(config.public(), sort_keys=False, allow_unicode=True))
    write_text(root / HIDDEN, yaml.safe_dump(hidden, sort_keys=False))


def check(plain: dict[str, Any]) -> None:
    """Check what only the library knows: rig numbers, trials, effects, parameter names."""
    rig = Rig.from_mapping(plain["rig"])
    trials = [Trial.from_plain(t) for t in plain["experiment"]["trials"]]
    names = [t.name for t in trials]
    if twice := {n for n in names if names.count(n) > 1}:
        raise ConfigError(f"experiment: trial name '{twice.pop()}' occurs twice")
    for role in ("train", "validate", "heldout"):
        if role not in {t.role for t in trials}:
            raise ConfigError(f"experiment: no trial has the role '{role}'")
    for name, settings in plain["experiments"].items():
        for play in experiment_from(name, settings).plays():
            Trial.from_plain(play.trial)
            Rig.from_mapping(merged(plain["rig"], play.rig))
    perceive = plain["perceive"]
    WrapSettings.from_mapping(perceive["wrap"] | perceive["drawn"]["wrap"])
    SizeSettings.from_mapping(perceive["size"])
    require_choices(perceive["choose"])
    find_effects(plain["diagnose"]["candidates"])
    plant = Plant(rig, find_effects(plain["plant"]["effects"]))
    for name in plain["identify"]["parameters"]:
        plant.table.position(name)


if __name__ == "__main__":
    run("config", stage)
