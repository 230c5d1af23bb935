"""An arm in simulation and a rig's inverse model answer the search alike."""

import numpy as np
import pytest

from spirob.diagnosis.criteria import Criteria, Settings
from spirob.diagnosis.fitting import begun
from spirob.diagnosis.model import Left
from spirob.diagnosis.simulated import ROLES, Simulated
from spirob.diagnosis.verdict import searched
from spirob.effects import find_effects
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import Sizes
from spirob.machine.recordings.recording import prepare
from spirob.machine.search.models import Models
from tests.identify.known import residual, spirob
from tests.machine.rigs import description

SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")
SETTINGS = Settings(intervals=False, most=1, iterations=3, patience=3)


def rig():
    """An axis with a drag that grows with the square of the speed."""
    described, logs = RigFile.model_validate(description()), []
    effects = find_effects(["constant_force", "quadratic_drag", "coulomb_friction"])
    for k in range(3):
        t = np.arange(0, 8, 4e-3)
        q = 2.0 * np.sin((2.1 + 0.2 * k) * t) + 0.8 * np.sin(4.3 * t + k)
        v = np.gradient(q, t)
        u = 0.03 * np.gradient(v, t) + 0.2 * v + 0.02 * v * np.abs(v)
        u += np.random.default_rng(k).normal(0.0, 0.02, len(t))
        logs.append(prepare(f"log{k}", {"t": t, "q": q, "u": u}, described))
    problems = [
        InverseProblem(described, None, of, effects, SIZES, 0.02) for of in (logs[:2], logs[2:])
    ]
    return Models(*problems, ["rig.inertia", "rig.viscous"]), effects, "quadratic_drag", Criteria()


def arm():
    """An arm whose sensor of the current is off."""
    effects = find_effects(["capstan_friction", "current_offset", "stiffness_hardening"])
    plant = spirob(effects)
    trials = {role: residual(plant, {"current_offset.offset": 0.06}, role) for role in ROLES}
    names = ["winch.efficiency", "motor.rotor_damping"]
    start = begun(trials["train"], names, {}, SETTINGS)
    return Simulated(trials, names, SETTINGS, start), effects, "current_offset", SETTINGS


@pytest.fixture(scope="module", params=[rig, arm], ids=["rig", "arm"])
def machine(request):
    return request.param()


def test_the_effect_that_is_missing_is_named(machine):
    models, effects, right, criteria = machine
    told: list[str] = []
    ended, verdict = searched(models, effects, criteria, told.append)
    assert (verdict.kind, verdict.named) == ("named", [right])
    assert {o.effect for o in ended.found.offers} == set(effects)
    assert told[-1].done == len(told) <= told[0].of, "what is expected at most is said"


def test_every_set_is_kept_and_begins_where_it_is_told_to(machine):
    models, _, right, criteria = machine
    bare = models.fitted((), {})
    (effect,) = find_effects([right])
    one = models.fitted((effect,), bare.fit.changes)
    assert models.tried[frozenset()] is bare
    assert models.tried[one.names] is one is models.fitted((effect,), {})
    assert set(models.names) <= set(bare.fit.estimates) <= set(one.fit.estimates)
    assert one.mean_square < 0.3 * bare.mean_square
    assert one.heldout_square < 0.3 * bare.heldout_square
    assert len(one.errors) >= len(one.left) // models.train.block // 3
    assert models.least >= 0.999 * criteria.floor * models.size


def test_offers_stand_the_best_first_with_numbers_to_start_from(machine):
    models, effects, right, _ = machine
    bare = models.fitted((), {})
    offers = models.offers(bare, effects)
    assert {o.effect for o in offers} == set(effects)
    assert [o.error for o in offers] == sorted(o.error for o in offers)
    assert (offers[0].effect.name(), offers[0].error < bare.mean_square) == (right, True)
    for offer in offers:
        own = {n for n in offer.values if n.startswith(f"{offer.effect.name()}.")}
        assert own, "its own numbers are among those to start from"
        assert 0.0 <= offer.new <= 1.0
    subset = models.offers(bare, effects[:2])
    assert {o.effect for o in subset} == set(effects[:2])


def test_a_round_gives_a_model_of_each_set_that_stands_among_those_tried(machine):
    models, effects, _, _ = machine
    bare = models.fitted((), {})
    sets = [(o,) for o in models.offers(bare, effects)[:2]]
    grown = models.grown(bare, sets, lambda before, after: False)
    assert [m.effects for m in grown] == [(o.effect,) for (o,) in sets]
    assert all(models.tried[m.names] is m for m in grown)


def test_pairs_are_of_two_offers_the_best_first(machine):
    models, effects, _, _ = machine
    bare = models.fitted((), {})
    offers = models.offers(bare, effects)
    pairs = models.pairs(bare, offers)
    assert [p[0] for p in pairs] == sorted(p[0] for p in pairs)
    for error, one, two in pairs:
        assert one.effect is not two.effect
        assert error <= 1.05 * min(one.error, two.error)


def test_a_chosen_model_is_finished_and_says_what_is_left_of_it(machine):
    models, _, right, _ = machine
    (effect,) = find_effects([right])
    one = models.finished(models.fitted((effect,), {}))
    assert one is models.tried[one.names]
    bare, left = models.fitted((), {}), models.left(one)
    assert isinstance(left, Left)
    assert 0.0 <= left.share <= 1.0
    assert models.left(bare).share > 0.5, "much is left of the numbers alone"
    assert all(models.left(bare).unknown)
    assert models.lacks(bare)
    assert models.nothing(bare).endswith(".")
    assert not models.related(effect, [])
    assert models.plain(one)
    assert set(models.scores(one)) >= {"train"}
