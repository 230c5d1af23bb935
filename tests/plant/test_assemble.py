"""The generated loop holds what was asked for, and says so when it cannot."""

import inspect
import re

import pytest

from spirob.effects import Effect
from spirob.effects.discovery import all_effects
from spirob.errors import EffectError
from spirob.parameter import Table
from spirob.plant import Rig, assemble, loop
from spirob.ports import PORTS


def _generated(effects):
    owners = [*Rig().parts(), *((e.name(), e(**e.neutral)) for e in effects)]
    return assemble.generate(effects, Table(owners).names)


@pytest.mark.parametrize("name", all_effects())
def test_an_effect_is_called_in_the_loop(name):
    effect = all_effects()[name]
    body = _generated([effect]).split("def run(")[1]
    assert re.search(rf"\bkernel_{name}\(", body)


def test_the_loop_has_a_place_for_every_port():
    places = {found[3] for found in assemble.MARK.finditer(inspect.getsource(loop.run))}
    assert places == set(PORTS)


def test_an_effect_without_a_place_is_refused(monkeypatch):
    effect = all_effects()["coulomb_friction"]
    assert issubclass(effect, Effect)
    # what a formatter that rewrites the marks would do
    monkeypatch.setattr(assemble, "MARK", re.compile(r"^( *)#nothing(\w)(\S)(\w)$", re.MULTILINE))
    with pytest.raises(EffectError, match=r"coulomb_friction.*motor\.torque"):
        _generated([effect])
