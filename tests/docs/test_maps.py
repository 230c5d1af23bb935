"""A package that says which file holds what names all of them, and none that is gone."""

import ast
import re
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2]
FILE = re.compile(r"\b(\w+)\.py\b")


def text_of(package):
    """What stands in a package's own file."""
    return (SOURCE / package / "__init__.py").read_text(encoding="utf-8")


def named(package):
    """The files that a package's docstring names."""
    return FILE.findall(ast.get_docstring(ast.parse(text_of(package))) or "")


PACKAGES = [str(p.parent.relative_to(SOURCE)) for p in (SOURCE / "spirob").rglob("__init__.py")]
MAPPED = sorted(package for package in PACKAGES if len(named(package)) > 1)


def test_rooms_of_many_files_have_a_map():
    rooms = ("emulator", "experiments", "export", "identify", "logs", "perceive", "plant", "report")
    assert {f"spirob/{room}" for room in rooms} <= set(MAPPED)


@pytest.mark.parametrize("package", MAPPED)
def test_a_map_shows_the_files_that_there_are(package):
    there = {file.stem for file in (SOURCE / package).glob("*.py")} - {"__init__", "__main__"}
    assert set(named(package)) - there == set()
    if "iter_modules(__path__" not in text_of(package):  # such are found by their files
        assert there - set(named(package)) == set()
