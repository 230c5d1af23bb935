"""What is installed, and on what."""

import ast
import runpy
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[1]
FIRST = SOURCE / "spirob/__init__.py"


def test_a_python_that_is_too_old_is_told_so(monkeypatch):
    ast.parse(FIRST.read_text(), feature_version=(3, 4))  # as far as such a one can read
    assert runpy.run_path(str(FIRST))["__version__"]
    monkeypatch.setattr(sys, "version_info", (3, 10, 4))
    monkeypatch.setattr(sys, "version", "3.10.4 (main)")
    with pytest.raises(ImportError, match=r"needs Python 3\.11 or newer; this is 3\.10"):
        runpy.run_path(str(FIRST))


def test_it_says_what_the_package_requires():
    required = tomllib.loads((SOURCE / "pyproject.toml").read_text())["project"]["requires-python"]
    assert required == ">=3.11"
    assert "(3, 11)" in FIRST.read_text()


def test_what_it_offers_is_listed_before_it_is_loaded():
    asked = "import spirob, sys; print('diagnose' in dir(spirob), 'spirob.machine' in sys.modules)"
    said = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True)
    assert said.stdout.split() == ["True", "False"]
