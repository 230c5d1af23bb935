"""`spirob --help` shows the way: on one screen, every command, what the exit codes mean."""

import subprocess
import sys

import pytest

from spirob.cli import MEANINGS
from spirob.cli.main import command_line, name_of, subcommands

SCREEN = (40, 100)  # lines, columns


@pytest.fixture(scope="module")
def shown():
    asked = [sys.executable, "-m", "spirob.cli.main", "--help"]
    return subprocess.run(asked, capture_output=True, text=True, check=True).stdout


def test_it_fits_on_a_screen(shown):
    lines = shown.splitlines()
    assert len(lines) <= SCREEN[0]
    assert max(len(line) for line in lines) <= SCREEN[1]


def test_every_command_and_every_exit_code_is_there(shown):
    for module in subcommands():
        assert f"  {name_of(module)} " in shown
        assert module.HELP in shown
    for code, meaning in MEANINGS.items():
        assert f"  {code}" in shown
        assert meaning in shown


def test_the_commands_on_the_way_exist(shown):
    named = {line.split()[1] for line in shown.splitlines() if line.startswith("  spirob ")}
    assert named >= {"run", "report", "diagnose"}
    assert named <= {name_of(module) for module in subcommands()}


def test_every_line_of_the_way_is_understood(shown):
    ways = [line.strip() for line in shown.splitlines() if line.startswith("  spirob ")]
    for line in ways:
        words = line.split("   ")[0].split("' ")[0].replace("'", "").split()
        assert callable(command_line().parse_args(words[1:]).run)


def test_without_a_command_the_help_is_shown_and_the_code_is_that_of_a_mistake():
    asked = [sys.executable, "-m", "spirob.cli.main"]
    done = subprocess.run(asked, capture_output=True, text=True)
    assert done.returncode == 2
    assert "commands:" in done.stdout


HEAVY = "numpy mujoco scipy sklearn numba pandas plotly pyarrow can cantools hydra dvc rich"
PROBE = """
import sys
from spirob.cli.main import main
try:
    main(sys.argv[1:])
except SystemExit:
    pass
print([name for name in {heavy!r}.split() if name in sys.modules], file=sys.stderr)
"""


@pytest.mark.parametrize("command", ["", *(name_of(module) for module in subcommands())])
def test_help_imports_no_heavy_module(command):
    asked = [sys.executable, "-c", PROBE.format(heavy=HEAVY), *command.split(), "--help"]
    done = subprocess.run(asked, capture_output=True, text=True, check=True)
    assert "usage:" in done.stdout
    assert done.stderr.strip() == "[]"
