"""The generated loop holds what was asked for, and says so when it cannot."""

import inspect
import re

import pytest

from spirob.effects import Effect, all_effects
from spirob.errors import EffectError
from spirob.plant import Plant, Rig, assemble
from spirob.ports import PORTS


def _filled(effects):
    """The loop's functions with every port filled in, without what they call."""
    return assemble.generate(effects).split("def begin(")[1]


IN_THE_LOOP = [n for n, e in all_effects().items() if PORTS[e.port].every != "once"]


@pytest.mark.parametrize("name", IN_THE_LOOP)
def test_an_effect_is_called_in_the_loop(name):
    effect = all_effects()[name]
    assert re.search(rf"\bkernel_{name}\(", _filled([effect]))


def test_the_loop_has_a_place_for_every_port():
    text = "\n".join(inspect.getsource(f) for f in assemble.TEMPLATES)
    places = {found[3] for found in assemble.MARK.finditer(text)}
    assert places == {name for name, port in PORTS.items() if port.every != "once"}


def test_what_nobody_reads_is_not_computed():
    assert "if False:\n        hinge_weights(" in _filled([all_effects()["coulomb_friction"]])
    assert "if True:\n        hinge_weights(" in _filled([all_effects()["mount_tilt"]])


def test_an_effect_without_a_place_is_refused(monkeypatch):
    effect = all_effects()["coulomb_friction"]
    assert issubclass(effect, Effect)
    # what a formatter that rewrites the marks would do
    monkeypatch.setattr(assemble, "MARK", re.compile(r"^( *)#nothing(\w)(\S)(\w)$", re.MULTILINE))
    with pytest.raises(EffectError, match=r"coulomb_friction.*motor\.torque"):
        assemble.generate([effect])


def test_all_sets_of_effects_share_what_they_leave_as_it_is():
    """Their machines are records of one kind, and a step that has none of them is one module."""
    effects = all_effects()
    sets = ([], ["coulomb_friction"], ["capstan_friction", "tip_payload"])
    plants = [Plant(Rig(), [effects[name] for name in names]) for names in sets]
    bare, *others = (plant.layout.of(plant.table.vector({})).dtype for plant in plants)
    assert all(one == bare for one in others)
    steps = [inspect.getmodule(plant.run).__dict__ for plant in plants]
    assert steps[0]["j_a"] is steps[1]["j_a"] is steps[2]["j_a"]
    assert steps[0]["j_c"] is steps[1]["j_c"] is not steps[2]["j_c"]
    assert steps[0]["j_b"] is not steps[1]["j_b"]
