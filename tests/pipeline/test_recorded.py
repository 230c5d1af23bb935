"""Logs of real hardware as inputs: kept by their content, pulled into a fresh clone, noticed."""

import sys
from types import SimpleNamespace

import pytest

from pipeline import record
from pipeline.schema import validated
from pipeline.stage import read_yaml
from pipeline.trials import recorded_trials, robot_wraps
from spirob.errors import HardwareError
from tests.pipeline.project import Project
from tests.trials.fake_robot import FakeRobot
from tests.trials.trials import record_on

OVERRIDES = ["recordings=short", "perceive=short", "robot=can"]
IDENTITY = ("-c", "user.name=tester", "-c", "user.email=tester@localhost")
LOGS = "data/recorded/logs"


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A project whose robot was recorded, its logs added to DVC and pushed to a remote."""
    folder = tmp_path_factory.mktemp("lab")
    project = Project(folder / "lab", OVERRIDES)
    project.stage("config")
    config = validated(read_yaml(project.root / "data/config/config.yaml", "config"), "config")
    names = [t["name"] for t in recorded_trials(config) + robot_wraps(config)]
    (project.root / LOGS).mkdir()
    for k, name in enumerate(names):
        record_on(FakeRobot(), project.root / LOGS, 0.2 + 0.01 * k, f"{name}.mcap")
    (project.root / ".dvc/config").write_text(
        f"[core]\n    remote = store\n    analytics = false\n['remote \"store\"']\n"
        f"    url = {folder / 'store'}\n"
    )
    project.run(sys.executable, "-m", "dvc", "add", "-q", LOGS)
    project.run(sys.executable, "-m", "dvc", "push", "-q", f"{LOGS}.dvc")
    project.run("git", "add", ".")
    project.run("git", *IDENTITY, "commit", "-q", "-m", "recorded")
    return project, names


def test_a_fresh_clone_gets_the_logs_and_runs_on_them(recorded, tmp_path):
    lab, names = recorded
    assert f"{LOGS}.dvc" in lab.run("git", "ls-files")
    assert ".mcap" not in lab.run("git", "ls-files")
    clone = Project.__new__(Project)
    clone.root = tmp_path / "clone"
    lab.run("git", "clone", "-q", str(lab.root), str(clone.root))
    clone.run(sys.executable, "-m", "dvc", "pull", "-q", f"{LOGS}.dvc")
    clone.run(sys.executable, "-m", "dvc", "repro", "decode")
    traces = clone.root / "data/traces"
    assert sorted(path.stem for path in traces.iterdir()) == sorted(names)
    for name in names:
        kept, raw = lab.root / LOGS / f"{name}.mcap", clone.root / f"data/raw/{name}.mcap"
        assert raw.read_bytes() == kept.read_bytes()
    before = (traces / f"{names[0]}.parquet").read_bytes()
    record_on(FakeRobot(), clone.root / LOGS, 0.3, "again.mcap")
    (clone.root / LOGS / "again.mcap").replace(clone.root / LOGS / f"{names[0]}.mcap")
    clone.run(sys.executable, "-m", "dvc", "repro", "decode")
    assert (traces / f"{names[0]}.parquet").read_bytes() != before


def test_a_log_that_is_missing_is_named(recorded):
    lab, names = recorded
    missing = lab.root / LOGS / f"{names[-1]}.mcap"
    kept = missing.read_bytes()
    missing.unlink()
    try:
        said = lab.stage("collect", code=2)
    finally:
        missing.write_bytes(kept)
    assert f"{LOGS}/{names[-1]}.mcap is missing" in said
    assert "`dvc pull`" in said


def test_a_stop_keeps_every_log_and_none_is_played_twice(tmp_path, monkeypatch):
    played, broken = [], ["second"]

    def record_all(root, config, hidden, trials):
        (trial,) = trials
        played.append(trial["name"])
        failed = trial["name"] in broken
        (root / "data/raw").mkdir(parents=True, exist_ok=True)
        (root / f"data/raw/{trial['name']}.mcap{'.part' * failed}").write_text(f"{len(played)}")
        if failed:
            raise HardwareError("no feedback from motor left for 11 ms")

    monkeypatch.setattr(record, "record_all", record_all)
    config = SimpleNamespace(robot=SimpleNamespace(kind="can"))
    monkeypatch.setattr(record, "public_config", lambda root: config)
    names = ("first", "second", "third")
    monkeypatch.setattr(record, "recorded_trials", lambda c: [{"name": n} for n in names])
    monkeypatch.setattr(record, "robot_wraps", lambda c: [])
    with pytest.raises(HardwareError, match="motor left"):
        record.stage(tmp_path)
    assert (tmp_path / "data/recorded/second.mcap.part").read_text() == "2"
    broken.clear()
    record.stage(tmp_path)
    assert played == ["first", "second", "second", "third"]
    found = {path.name: path.read_text() for path in (tmp_path / LOGS).iterdir()}
    assert found == {"first.mcap": "1", "second.mcap": "3", "third.mcap": "4"}
