"""Every `python -m` of the project says with --help what it is about, and does nothing."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[1]
HERE = {**os.environ, "PYTHONPATH": str(SOURCE)}  # `pipeline` is a clone's, never installed
ENTRIES = sorted(
    ".".join(path.relative_to(SOURCE).with_suffix("").parts).removesuffix(".__main__")
    for folder in ("pipeline", "spirob")
    for path in (SOURCE / folder).rglob("*.py")
    if 'if __name__ == "__main__":' in path.read_text(encoding="utf-8")
)


def test_they_are_found():
    assert {"pipeline.record", "pipeline.wraps", "spirob.emulator", "spirob.ending"} <= set(ENTRIES)


@pytest.mark.parametrize("entry", ENTRIES)
def test_help_helps_and_does_nothing(tmp_path, entry):
    done = subprocess.run(
        [sys.executable, "-m", entry, "--help"],
        cwd=tmp_path,
        env=HERE,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert "usage: " in done.stdout or "powered by Hydra" in done.stdout
    assert list(tmp_path.iterdir()) == []


def test_a_stage_takes_no_arguments(tmp_path):
    asked = [sys.executable, "-m", "pipeline.record", "--now"]
    done = subprocess.run(asked, cwd=tmp_path, env=HERE, capture_output=True, text=True)
    assert done.returncode == 2
    assert "--now" in done.stderr
