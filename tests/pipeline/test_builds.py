"""How the emulated robot is built reaches the robot and nobody else."""

from pathlib import Path

import pytest
import yaml

from pipeline.config import composed, write
from pipeline.robots import build
from pipeline.schema import validated
from pipeline.stage import HIDDEN, PUBLIC, public_config
from spirob.emulator import EmulatedRobot
from spirob.errors import ConfigError
from spirob.plant import Rig

ROOT = Path(__file__).parents[2]


def configured(folder, *overrides):
    """The public configuration and the hidden one, as the stage `config` writes them."""
    write(folder, composed(ROOT, list(overrides)), "conf")
    return public_config(folder), yaml.safe_load((folder / HIDDEN).read_text())


def test_it_is_as_designed_where_nothing_is_said(tmp_path):
    config, hidden = configured(tmp_path)
    assert hidden["build"] == config.trial.build == "as_designed"


def test_a_chosen_build_is_built_and_not_told(tmp_path):
    config, hidden = configured(tmp_path, "robot.build=rough")
    robot = build(config, Rig.from_mapping(config.rig), hidden)
    assert isinstance(robot, EmulatedRobot)
    assert robot.truth()["build"]["name"] == "rough"
    robot.close()
    assert "build" not in yaml.safe_load((tmp_path / PUBLIC).read_text())["robot"]
    plain, _ = configured(tmp_path / "plain")
    assert config.public() == plain.public()
    assert "build" not in config.public()["robot"]


@pytest.mark.parametrize("key", ["robot.build", "trial.build"])
def test_an_unknown_build_is_a_sentence_with_the_key(key):
    with pytest.raises(ConfigError, match=rf"conf: key '{key}': .*'typical' or 'rough'"):
        validated(composed(ROOT, [f"{key}=perfect"]), "conf")
