"""Every `python -m` of the project says with --help what it is about, and does nothing."""

import json
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


WRONG = ["pipeline.record", "--now"]


@pytest.fixture(scope="module")
def ended(tmp_path_factory):
    """Of each command the folder with what it said, its code, and the folder in which it ran."""
    folder = tmp_path_factory.mktemp("entries")
    commands = [[entry, "--help"] for entry in ENTRIES] + [WRONG]
    runner = [sys.executable, "-m", "tests.forked", str(folder), json.dumps(commands)]
    subprocess.run(runner, cwd=SOURCE, env=HERE, check=True, timeout=300)
    return {tuple(command): folder / str(k) for k, command in enumerate(commands)}


def test_they_are_found():
    assert {"pipeline.record", "pipeline.wraps", "spirob.emulator", "spirob.ending"} <= set(ENTRIES)


@pytest.mark.parametrize("entry", ENTRIES)
def test_help_helps_and_does_nothing(ended, entry):
    done = ended[entry, "--help"]
    assert (done / "code").read_text() == "0", (done / "err").read_text()
    said = (done / "out").read_text()
    assert "usage: " in said or "powered by Hydra" in said
    assert list((done / "empty").iterdir()) == []


def test_a_stage_takes_no_arguments(ended):
    done = ended[tuple(WRONG)]
    assert (done / "code").read_text() == "2"
    assert "--now" in (done / "err").read_text()
