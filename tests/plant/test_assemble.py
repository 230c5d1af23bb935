"""The generated loop holds what was asked for, and says so when it cannot."""

import inspect
import re

import pytest

from spirob.effects import Effect
from spirob.effects.discovery import all_effects
from spirob.errors import EffectError
from spirob.plant import Plant, Rig, assemble, loop
from spirob.ports import PORTS


def _generated(effects):
    return assemble.generate(effects, Plant(Rig(), effects).table.names)


IN_THE_LOOP = [n for n, e in all_effects().items() if PORTS[e.port].every != "once"]


@pytest.mark.parametrize("name", IN_THE_LOOP)
def test_an_effect_is_called_in_the_loop(name):
    effect = all_effects()[name]
    body = _generated([effect]).split("def run(")[1]
    assert re.search(rf"\bkernel_{name}\(", body)


def test_the_loop_has_a_place_for_every_port():
    places = {found[3] for found in assemble.MARK.finditer(inspect.getsource(loop.run))}
    assert places == {name for name, port in PORTS.items() if port.every != "once"}


def test_what_nobody_reads_is_not_computed():
    body = _generated([all_effects()["coulomb_friction"]]).split("def run(")[1]
    assert "if False:\n                hinge_weights(" in body
    body = _generated([all_effects()["mount_tilt"]]).split("def run(")[1]
    assert "if True:\n                hinge_weights(" in body


def test_an_effect_without_a_place_is_refused(monkeypatch):
    effect = all_effects()["coulomb_friction"]
    assert issubclass(effect, Effect)
    # what a formatter that rewrites the marks would do
    monkeypatch.setattr(assemble, "MARK", re.compile(r"^( *)#nothing(\w)(\S)(\w)$", re.MULTILINE))
    with pytest.raises(EffectError, match=r"coulomb_friction.*motor\.torque"):
        _generated([effect])
