"""The arm from anybody's CSV: the hidden effect is named, in the same words as any rig's."""

import json
from types import SimpleNamespace

import pandas as pd
import pytest

from spirob.diagnosis.criteria import Settings
from spirob.diagnosis.schema import checked, unknown
from spirob.effects import all_effects
from spirob.errors import ConfigError
from spirob.machine.arm import diagnosis
from spirob.machine.arm.diagnosis import overlay, parameters
from spirob.machine.loading import load_rig
from tests.machine.arm.elsewhere import log, rig, tables, write

FRICTION = all_effects()["coulomb_friction"]
TRUE = {"winch.efficiency": 0.7, "coulomb_friction.coulomb_torque": 0.004}


def test_a_hidden_friction_is_named_and_the_held_out_error_falls(tmp_path):
    paths = []
    for role, k in (("train", 0), ("train", 1), ("validate", 0), ("heldout", 0)):
        paths.append(tmp_path / f"{role}_{k}.csv")
        pd.DataFrame(log(role, k, TRUE, [FRICTION])).to_csv(paths[-1], index=False, sep=";")
    arm = rig(fit=["winch.efficiency", "motor.rotor_damping"])
    trials, said = diagnosis.read(arm, tables(paths[:3]), tables(paths[3:]))
    settings = Settings(finalists=1, most=1, intervals=False)
    found = diagnosis.searched(arm, trials, settings, print, [FRICTION])
    document = json.loads(json.dumps(checked(diagnosis.written(arm, found, said))))
    assert unknown(document) == ""
    assert document["verdict"] == "named"
    (effect,) = document["effects"]
    assert effect["name"] == "coulomb_friction"
    assert effect["parameters"]["coulomb_torque"]["value"] == pytest.approx(0.004, rel=0.1)
    before, after, ceiling = (rung["test"]["rmse"] for rung in document["ladder"])
    assert after < 0.4 * before
    assert ceiling < 1.05 * after
    assert document["ladder"][-1]["ceiling"]
    for rung in document["ladder"]:
        assert set(rung["interval"]) == {"train", "validate", "heldout", "test"}
    assert any("read with ';'" in text for text in document["repairs"])
    assert document["floor"]["share"] == found.floor.share
    assert "builds of this machine" in document["floor"]["reason"]
    shown = overlay(found)
    assert {"trial", "role", "time", "measured", "base", "named"} <= set(shown.columns)
    assert parameters(found)["winch.efficiency"]["unit"] == "1"


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"left": {"position": {"column": "a", "unit": "deg"}}}, "left.effort: Field required"),
        ({"position": {"column": "q", "unit": "m"}}, "position: no such key"),
        ({"time": {"column": "t", "unit": "hours"}}, r"time\.unit: 'hours'"),
    ],
)
def test_a_mistake_in_the_description_names_its_place(tmp_path, changes, sentence):
    with pytest.raises(ConfigError, match=sentence):
        load_rig(write(tmp_path, **changes))


def test_an_unknown_number_is_named(tmp_path):
    arm = rig(fit=["winch.colour"])
    with pytest.raises(ConfigError, match=r"no number 'winch\.colour'"):
        diagnosis.searched(arm, {}, Settings(), print, [])


@pytest.mark.parametrize(("named", "which"), [(["coulomb_friction"], 1), ([], 0)])
def test_the_shape_beside_the_best_effect_is_taken_where_that_is_named(monkeypatch, named, which):
    """Its numbers are those of the ground; those without an effect stay what they were."""
    models = [
        SimpleNamespace(effects=effects, mean_square=square, fit=f"fit of {square}")
        for effects, square in (((), 9.0), (("a",), 3.0), (("b",), 4.0), (("a", "b"), 1.0))
    ]
    tried = SimpleNamespace(tried=dict(enumerate(models)))
    grounds = [SimpleNamespace(numbers=n) for n in ({"alone": 1.0}, {"with it": 2.0})]
    first, again = (
        SimpleNamespace(models=tried, verdict=SimpleNamespace(named=n)) for n in ([], named)
    )
    asked_for = []
    monkeypatch.setattr(
        diagnosis, "settled_with", lambda *given: asked_for.append(given[1]) or grounds[1]
    )
    monkeypatch.setattr(diagnosis, "label", str)
    monkeypatch.setattr(
        diagnosis.Asked, "searched", lambda self, *given: asked_for.append(given) or again
    )
    asked = diagnosis.Asked({}, [], [], ["holes.shift"], Settings(), print)
    ground, found = asked.with_contender(grounds[0], first)
    assert asked_for == ["fit of 3.0", (grounds[1], {"alone": 1.0}, ("a",))]
    assert (ground, found) == (grounds[which], (first, again)[which])
