"""How sure a name is, and what says most of the same."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from spirob.machine.figures import Ended, kin
from spirob.machine.judgement import LIKELY, Words, likely, weigh

from spirob.diagnosis.certainty import FIGURES, LEARNED, probability
from spirob.effects import all_effects
from spirob.machine import judgement

NAMES = ("coulomb_friction", "presliding_friction", "cogging")
COULOMB = all_effects()["coulomb_friction"]


@dataclass(frozen=True)
class Fitted:
    """A fitted model: names of its effects, residual (N,) and held-out error."""

    names: frozenset
    residual: np.ndarray
    heldout_square: float

    @property
    def fit(self):
        return SimpleNamespace(residual=self.residual)

    @property
    def effects(self):
        return tuple(all_effects()[n] for n in self.names)

    @property
    def mean_square(self):
        return float(np.mean(self.residual**2))


def searched(apart, far):
    """A law of one, another that is `apart` from it (RMS), and a third that is `far`."""
    wave = np.tile([1.0, -1.0], 50)
    models = [
        Fitted(frozenset(), np.ones(100), 1.0),
        Fitted(frozenset(NAMES[:1]), np.zeros(100), 0.01),
        Fitted(frozenset(NAMES[1:2]), apart * wave, 0.02),
        Fitted(frozenset(NAMES[2:]), far * wave, 0.5),
    ]
    tried = {m.names: m for m in models}
    return SimpleNamespace(models=SimpleNamespace(tried=tried)), models[1]


def test_what_makes_most_of_an_effect_is_of_its_kin():
    search, chosen = searched(0.1, 0.9)
    assert kin(search, chosen, COULOMB) == ["presliding_friction"]
    search, chosen = searched(0.1, 0.2)
    assert kin(search, chosen, COULOMB) == ["presliding_friction", "cogging"]  # the better first
    search, chosen = searched(0.9, 0.9)
    assert kin(search, chosen, COULOMB) == []


@pytest.mark.parametrize(
    ("alone", "whole", "rivals"),
    [(0.3, 0.8, ["presliding_friction"]), (0.3, 0.4, []), (0.7, 0.9, [])],
)
def test_a_name_that_is_unlikely_alone_may_be_likely_with_its_kin(
    monkeypatch, alone, whole, rivals
):
    """It is then one of several, between which nothing is decided."""
    monkeypatch.setattr(judgement, "figures", lambda *a: {"same": len(a[2]) if a[2:] else 0})
    monkeypatch.setattr(judgement, "probability", lambda f: whole if f["same"] else alone)
    monkeypatch.setattr(judgement, "is_bent", lambda *a: False)
    search, chosen = searched(0.1, 0.9)
    search.worth = SimpleNamespace(least=0.01)
    found = SimpleNamespace(chosen=chosen, rivals={"coulomb_friction": []})
    weighed = weigh(Ended(search, found, None))
    one = weighed["coulomb_friction"]
    assert one.probability == alone
    assert one.rivals == rivals
    assert bool(likely(weighed)) == (max(one.together, alone) >= LIKELY)


def test_dry_friction_of_another_shape_is_withheld_with_its_kin(monkeypatch):
    monkeypatch.setattr(judgement, "figures", lambda *a: {})
    monkeypatch.setattr(judgement, "probability", lambda f: 0.99)
    monkeypatch.setattr(judgement, "is_bent", lambda *a: True)
    search, chosen = searched(0.1, 0.9)
    search.worth = SimpleNamespace(least=0.01)
    found = SimpleNamespace(chosen=chosen, rivals={"coulomb_friction": []})
    weighed = weigh(Ended(search, found, None))
    assert weighed["coulomb_friction"].probability == 0.0
    assert likely(weighed) == []


def test_more_of_what_speaks_for_a_name_makes_it_likelier():
    middle = dict(zip(FIGURES, LEARNED["mean"], strict=True))
    for figure in ("fall_heldout", "ahead_heldout", "sharp"):
        more = middle | {figure: middle[figure] + 1.0}
        assert probability(more) > probability(middle)
    assert probability(middle | {"left": middle["left"] + 1.0}) < probability(middle)


@pytest.mark.parametrize(
    ("rival", "said"),
    [
        ("presliding_friction", "dry friction by one of its laws (coulomb friction or presliding"),
        ("load_dependent_friction", "Undecided: coulomb friction or load dependent friction."),
    ],
)
def test_where_only_laws_of_dry_friction_are_in_question_dry_friction_is_said(
    monkeypatch, rival, said
):
    monkeypatch.setattr(Words, "_fall", lambda words: "")
    monkeypatch.setattr(Words, "_left", lambda words: "")
    search = SimpleNamespace(candidates=[all_effects()[n] for n in (*NAMES, rival)])
    after = SimpleNamespace(effects=(COULOMB,))
    words = Words(search, None, after, None, None, SimpleNamespace(name="motor current"))
    name = COULOMB.name()
    sentence, _ = words.say("undecided", {name: []}, {name: [rival]}, [])
    assert said in sentence
