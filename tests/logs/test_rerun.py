"""A log opens in Rerun: its own checker finds nothing wrong with structure and timelines."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.trials.fake_robot import FakeRobot
from tests.trials.trials import record_on

BESIDE = Path(sys.executable).with_name("rerun")
RERUN = str(BESIDE) if BESIDE.exists() else shutil.which("rerun")
pytestmark = pytest.mark.skipif(RERUN is None, reason="needs rerun-sdk, of the test extra")


def rerun(home, *arguments):
    quiet = os.environ | {"HOME": str(home), "XDG_CONFIG_HOME": str(home / ".config")}
    return subprocess.run(
        [RERUN, *arguments], env=quiet, capture_output=True, text=True, timeout=120
    )


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """A home folder of its own, in which Rerun keeps that it must not send usage data."""
    folder = tmp_path_factory.mktemp("home")
    rerun(folder, "analytics", "disable")
    return folder


def test_reruns_checker_finds_nothing_wrong(home, tmp_path):
    path = record_on(FakeRobot(), tmp_path, 1.0, "trial.mcap")
    checked = rerun(home, "mcap", "check", "--full", str(path or tmp_path / "trial.mcap"))
    assert checked.returncode == 0, checked.stdout + checked.stderr
    rows = [line.split() for line in checked.stdout.splitlines() if "/" in line and "—" in line]
    assert {row[3]: row[0] for row in rows} == {
        "/can/raw": "ok",
        "/joint_states": "ok",
        "/command": "ok",
    }


def test_and_would_find_a_torn_file_wrong(home, tmp_path):
    record_on(FakeRobot(), tmp_path, 1.0, "trial.mcap")
    whole = (tmp_path / "trial.mcap").read_bytes()
    (tmp_path / "torn.mcap").write_bytes(whole[: len(whole) // 2])
    assert rerun(home, "mcap", "check", "--full", str(tmp_path / "torn.mcap")).returncode != 0
