"""A package that says which file holds what names all of them, and none that is gone."""

import ast
import re
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2]
FILE = re.compile(r"\b(\w+)\.py\b")
FEW = 3  # files that are found without a map
WALK = re.compile(r"(iter_modules|walk_packages)\((?:(\w+)\.)?__path__")


def text_of(package):
    """What stands in a package's own file."""
    return (SOURCE / package / "__init__.py").read_text(encoding="utf-8")


def named(package):
    """The files that a package's docstring names."""
    return FILE.findall(ast.get_docstring(ast.parse(text_of(package))) or "")


def files(package):
    """The files of a package besides its own, by their names."""
    return {file.stem for file in (SOURCE / package).glob("*.py")} - {"__init__", "__main__"}


def walked(text):
    """The folders whose files this source finds by walking them; "" is its own, "*" all below."""
    return {"*" if how == "walk_packages" else name.lstrip("_") for how, name in WALK.findall(text)}


def of_plugins(package):
    """Whether each file of a package is found because it is there, and no list names it."""
    here = SOURCE / package
    above = [walked(file.read_text(encoding="utf-8")) for file in here.parent.glob("*.py")]
    return "" in walked(text_of(package)) or any({here.name, "*"} & found for found in above)


PACKAGES = [str(p.parent.relative_to(SOURCE)) for p in (SOURCE / "spirob").rglob("__init__.py")]
MAPPED = sorted(package for package in PACKAGES if len(named(package)) > 1)


def test_what_is_walked_is_seen():
    assert walked("pkgutil.iter_modules(__path__)") == {""}
    assert walked("iter_modules(_targets.__path__)") == {"targets"}
    assert walked("walk_packages(__path__, name)") == {"*"}
    plugins = {package for package in PACKAGES if of_plugins(package)}
    assert {"spirob/export/targets", "spirob/effects/motor", "spirob/cli/commands"} <= plugins
    assert not {"spirob/export", "spirob/effects", "spirob/machine/laws"} & plugins


@pytest.mark.parametrize("package", sorted(set(PACKAGES) - set(filter(of_plugins, PACKAGES))))
def test_a_room_of_many_files_has_a_map(package):
    assert len(files(package)) <= FEW or package in MAPPED


@pytest.mark.parametrize("package", MAPPED)
def test_a_map_shows_the_files_that_there_are(package):
    assert set(named(package)) - files(package) == set()
    if not of_plugins(package):
        assert files(package) - set(named(package)) == set()
