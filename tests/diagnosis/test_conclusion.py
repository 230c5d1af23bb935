"""What stays of a search has to stand without what goes."""

import numpy as np
import pytest

from spirob.diagnosis import conclusion as module
from spirob.diagnosis.conclusion import concluded, likely
from spirob.diagnosis.criteria import Criteria
from spirob.diagnosis.search import Search
from spirob.effects import find_effects
from tests.diagnosis.machines import SAMPLES, Linear, ended, model

EFFECT, KIN, OTHER, FAR = find_effects(
    ["coulomb_friction", "presliding_friction", "cogging", "load_dependent_friction"]
)
NAME = EFFECT.name()
BARE = model([], 0.010)


@pytest.mark.parametrize("confirmed", [True, False])
def test_what_held_out_trials_confirm_only_beside_what_goes_is_not_named(confirmed, monkeypatch):
    """KIN takes half of what EFFECT leaves held out, but by itself nothing if not confirmed."""
    chance = lambda figures, name, of: 0.1 if name == OTHER.name() else 0.9  # noqa: E731
    monkeypatch.setattr(module, "probability", chance)
    models = [
        model([EFFECT], 0.006, 0.004),
        model([KIN], 0.009, 0.009),
        model([OTHER], 0.009, 0.009),
        model([EFFECT, KIN], 0.004, 0.003 if confirmed else 0.00399),
        model([EFFECT, OTHER], 0.005, 0.004),
        model([KIN, OTHER], 0.008, 0.008),
        model([EFFECT, KIN, OTHER], 0.002, 0.002),
    ]
    one = ended(BARE, *models, least=0.0005)
    last, weighed = concluded(one.search, one.found)
    assert last.found.chosen.names == ({NAME, KIN.name()} if confirmed else {NAME})
    assert likely(weighed) == ([NAME, KIN.name()] if confirmed else [NAME])
    assert weighed[KIN.name()].probability == (0.9 if confirmed else 0.0)


def test_what_was_likely_beside_a_dropped_effect_is_asked_again_alone(monkeypatch):
    """EFFECT makes a part of what FAR makes whole, and OTHER, which is dropped, the rest."""
    one, two = np.random.default_rng(2).standard_normal((2, 2 * SAMPLES))
    machine = Linear(0.1 * (one + two), {EFFECT: one, OTHER: two, FAR: one + two})
    search = Search(machine, [EFFECT, OTHER, FAR], Criteria(most=2))
    chance = lambda figures, name, of: 0.1 if name == OTHER.name() else 0.9  # noqa: E731
    monkeypatch.setattr(module, "probability", chance)
    search.run()
    pair = search.settled(machine.fitted((EFFECT, OTHER), {}))
    assert pair.chosen.names == {NAME, OTHER.name()}
    last, weighed = concluded(search, pair)
    assert last.found.chosen.names == {FAR.name()}
    assert likely(weighed) == [FAR.name()]
    assert weighed[OTHER.name()].probability == 0.1


@pytest.mark.parametrize(("sharpness", "goes"), [(-0.2, True), (0.0, True), (0.2, False)])
def test_of_effects_that_hide_each_other_one_that_ended_at_a_cap_goes(sharpness, goes, monkeypatch):
    """Its amplitude is told by the bound (0) or not at all; alone the other would be likely."""
    known = {NAME: 1.0, OTHER.name(): sharpness}

    def shown(one, effect):
        beside = len(one.found.chosen.effects) - 1.0
        return {"fall_heldout": 1.0, "sharp": known[effect.name()], "place": beside}

    monkeypatch.setattr(module, "figures", shown)
    monkeypatch.setattr(module, "probability", lambda f, name, of: 0.2 if f["place"] else 0.9)
    both = model([EFFECT, OTHER], 0.01)
    one = ended(model([], 0.1), model([OTHER], 0.06), model([EFFECT], 0.02), both)
    last, weighed = concluded(one.search, one.found)
    assert likely(weighed) == ([NAME] if goes else [])
    assert last.found.chosen.names == ({NAME} if goes else {NAME, OTHER.name()})
