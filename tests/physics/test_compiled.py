"""Compiled and interpreted, the cycle gives the same numbers before contact."""

import os
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from spirob.effects import find_effects
from spirob.plant import Plant, Response
from spirob.robot import Scene
from tests.physics.playing import GEARED, winding

ROOT = Path(__file__).resolve().parents[2]
# of every way to combine and remember: sum, pipe, probe, guide, hinge, state
EFFECTS = {
    "bare": [],
    "with_effects": ["coulomb_friction", "capstan_friction", "joint_viscoelasticity"],
}


def play(name):
    """A third of a second of winding in; the arm meets nothing."""
    effects = find_effects(EFFECTS[name])
    nominal = {f"{e.name()}.{f}": a.nominal for e in effects for f, a in e.parameters().items()}
    response = Plant(GEARED, effects).simulate(winding(0.05, 0.2, 0.33), Scene(), nominal)
    return {f.name: getattr(response, f.name) for f in fields(Response)}


@pytest.fixture(scope="module")
def interpreted(tmp_path_factory):
    path = tmp_path_factory.mktemp("interpreted") / "played.npz"
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    command = [sys.executable, "-m", "tests.physics.interpreted", str(path)]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return np.load(path)


@pytest.mark.parametrize("name", EFFECTS)
def test_compiled_is_interpreted(interpreted, name):
    for signal, values in play(name).items():
        wanted = interpreted[f"{name}_{signal}"]
        scale = np.abs(wanted).max()
        assert values == pytest.approx(wanted, rel=1e-9, abs=1e-9 * scale), signal


def test_the_effects_change_what_is_compared(interpreted):
    apart = interpreted["with_effects_current"] - interpreted["bare_current"]
    assert np.abs(apart).max() > 0.01
