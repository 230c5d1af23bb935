"""How the emulated robot is built reaches the robot and nobody else."""

from pathlib import Path

import pytest
import yaml

from pipeline.config import composed, write
from pipeline.robots import build
from pipeline.schema import validated
from pipeline.stage import HIDDEN, PUBLIC, public_config
from spirob.campaign.arm import running
from spirob.cli.main import main
from spirob.emulator import EmulatedRobot
from spirob.errors import ConfigError
from spirob.plant import Rig
from tests.campaign.arm.test_killed import fake
from tests.pipeline.project import SHORT

ROOT = Path(__file__).parents[2]


def configured(folder, *overrides):
    """The public configuration and the hidden one, as the stage `config` writes them."""
    write(folder, composed(ROOT, list(overrides)), "conf")
    return public_config(folder), yaml.safe_load((folder / HIDDEN).read_text())


@pytest.mark.parametrize("choices", [[], SHORT], ids=["full", "short"])
def test_it_is_typical_where_nothing_is_said(tmp_path, choices):
    config, hidden = configured(tmp_path, *choices)
    assert hidden["build"] == config.trial.build == "typical"
    unsaid = config.public()
    del unsaid["trial"]["build"]
    found = validated(unsaid, "conf")
    assert found.robot.build == found.trial.build == "typical"


def test_a_trial_plays_typical_builds_where_nothing_is_said(monkeypatch, tmp_path):
    played = []

    def run(case, settings):
        played.append(case)
        return [{**fake(case, settings)[0], "kind": case.kind}]

    monkeypatch.setattr(running, "run", run)
    table = str(tmp_path / "cases.jsonl")
    assert main(["trial", "--kinds", "cogging", "--workers", "1", "--out", table]) == 0
    assert {case.build for case in played} == {"typical"}


@pytest.mark.parametrize("name", ["as_designed", "typical", "rough"])
def test_a_chosen_build_is_built_and_not_told(tmp_path, name):
    config, hidden = configured(tmp_path, f"robot.build={name}")
    robot = build(config, Rig.from_mapping(config.rig), hidden)
    assert isinstance(robot, EmulatedRobot)
    assert robot.truth()["build"]["name"] == name
    robot.close()
    assert "build" not in yaml.safe_load((tmp_path / PUBLIC).read_text())["robot"]
    plain, _ = configured(tmp_path / "plain")
    assert config.public() == plain.public()
    assert "build" not in config.public()["robot"]


@pytest.mark.parametrize("key", ["robot.build", "trial.build"])
def test_an_unknown_build_is_a_sentence_with_the_key(key):
    with pytest.raises(ConfigError, match=rf"conf: key '{key}': .*'typical' or 'rough'"):
        validated(composed(ROOT, [f"{key}=perfect"]), "conf")


def test_the_same_robot_is_built_anew_by_a_seed_of_its_own(tmp_path):
    truths = []
    for k, built in enumerate(("null", "7")):
        config, hidden = configured(tmp_path / str(k), f"robot.hidden.built={built}")
        robot = build(config, Rig.from_mapping(config.rig), hidden)
        assert isinstance(robot, EmulatedRobot)
        truths.append(robot.truth())
        robot.close()
        assert "built" not in (tmp_path / str(k) / PUBLIC).read_text()
    own, anew = truths
    assert own["hidden"] == anew["hidden"]
    assert own["build"]["rows"]["hole"] != anew["build"]["rows"]["hole"]
