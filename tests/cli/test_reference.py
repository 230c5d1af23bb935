"""The reference is made from the source: every module, every public name, nothing imported."""

import importlib

import pytest

from spirob.cli.commands.reference import modules, page
from spirob.cli.main import main


@pytest.fixture(scope="module")
def found():
    return {module.name: module for module in modules()}


@pytest.mark.parametrize("name", ["spirob.ports", "spirob.geometry", "spirob.errors"])
def test_what_it_says_is_what_the_module_says(found, name):
    module = importlib.import_module(name)
    own = {
        key: value
        for key, value in vars(module).items()
        if getattr(value, "__module__", "") == name and callable(value) and key[0] != "_"
    }
    assert {member.name for member in found[name].members} == set(own)
    for key, value in own.items():
        assert value.__doc__.strip().splitlines()[0] in page(found[name]), key


def test_every_public_module_says_what_it_is(found):
    assert [name for name, module in found.items() if not module.text] == []


def test_signatures_carry_their_types(found):
    text = page(found["spirob.geometry"])
    assert "spiral_arm(units: int=24, size: float=1.0) -> SpiralArm" in text
    assert "unit_length: np.ndarray" in text


def test_reading_executes_nothing(tmp_path):
    package = tmp_path / "spirob"
    package.mkdir()
    (package / "trap.py").write_text('"""A trap."""\nraise SystemExit\n\ndef f(x):\n    """F."""\n')
    (trap,) = modules(package)
    assert trap.name == "spirob.trap"
    assert "f(x)" in page(trap)


def test_the_command_lists_prints_and_writes(found, tmp_path, capsys):
    assert main(["reference"]) == 0
    assert "spirob.ports " in capsys.readouterr().out
    assert main(["reference", "spirob.ports"]) == 0
    assert "## Port" in capsys.readouterr().out
    assert main(["reference", "--out", str(tmp_path)]) == 0
    written = {path.stem for path in tmp_path.glob("*.md")}
    assert written == set(found) | {"index"}
    assert main(["reference", "spirob.magic"]) == 2
