"""Robots built anew wrap what the robot wraps, and the shipped predictor tells their sizes."""

import json
from pathlib import Path

import pytest

from pipeline import config as configured
from pipeline import other_builds
from pipeline.stage import public_config, write_json
from pipeline.train import learnt
from pipeline.trials import robot_wraps, train_wraps
from pipeline.wraps import wrapped
from spirob.errors import ConfigError
from spirob.perceive.model_file import save_model

ROOT = Path(__file__).parents[2]
MODEL = {"effects": [], "changes": {}}


def configure(root, *overrides):
    configured.write(root, configured.composed(ROOT, ["perceive=short", *overrides]), "conf")
    return public_config(root)


def test_each_build_has_its_own_error_and_all_of_them_one(tmp_path, monkeypatch):
    config = configure(tmp_path)
    size, _ = learnt(wrapped(config, MODEL, train_wraps(config), training=True), config)
    save_model(size, tmp_path / "data/models/size.skops")
    monkeypatch.setattr(other_builds, "BUILDS", 2)
    other_builds.stage(tmp_path)
    found = json.loads((tmp_path / "reports/metrics/other_builds.json").read_text())
    assert list(found["builds"]) == ["build_2", "build_3"]  # the robot's own is 1
    errors = [told["mae"] for told in found["builds"].values()]
    assert errors[0] != errors[1]
    assert found["mae"]["most"] == max(errors)
    assert found["mae"]["median"] == pytest.approx(sum(errors) / 2)
    assert not (tmp_path / "data/truth").exists()  # where the robot's own shape lies
    logs = sorted(tmp_path.glob("data/other_builds/2/*.mcap"))
    assert [log.stem for log in logs] == sorted(t["name"] for t in robot_wraps(config))


def test_no_build_is_the_robots_own():
    assert other_builds.seeds(3, 1) == [2, 3, 4]
    assert other_builds.seeds(3, 2) == [1, 3, 4]
    assert other_builds.seeds(3, 9) == [1, 2, 3]


def test_only_an_emulated_robot_is_built_anew(tmp_path):
    configure(tmp_path, "robot=simulated")
    write_json(tmp_path / "data/models/size.skops", {})
    with pytest.raises(ConfigError, match="only an emulated robot can be built anew"):
        other_builds.stage(tmp_path)
