"""What was added is questioned again: exchanged for what explains more, taken out if not needed."""

import pytest
from spirob.diagnosis.backward import exchanged, pruned
from spirob.diagnosis.rungs import ROLES, Ladder, Rung, Settings, label, parameters_of, scores_of

from spirob.effects import find_effects
from spirob.identify.fit import STEPS, fit
from tests.identify.known import residual, spirob

NAMES = ["winch.efficiency", "arm.base_stiffness"]
FRICTION, OFFSET, OTHER = find_effects(["capstan_friction", "current_offset", "coulomb_friction"])
NUMBERS = {
    FRICTION: "capstan_friction.friction",
    OFFSET: "current_offset.offset",
    OTHER: "coulomb_friction.coulomb_torque",
}
TRUE = {NUMBERS[FRICTION]: 0.08, NUMBERS[OFFSET]: 0.04}
SETTINGS = Settings(intervals=False, patience=3)


@pytest.fixture(scope="module")
def residuals():
    plant = spirob([FRICTION, OFFSET, OTHER])
    return {role: residual(plant, TRUE, role) for role in ROLES}


def rung(residuals, effects):
    names = [*NAMES, *(NUMBERS[e] for e in effects)]
    start = {name: value for name, value in TRUE.items() if name in names}
    found = fit(residuals["train"], names, start, 0.05, 3, steps=STEPS[-1:], exact=False)
    scores, _, errors = scores_of(found, residuals)
    return Rung(f"+ {label(effects)}", effects, found, scores, errors)


def climbed(residuals, *rungs):
    ladder = [rung(residuals, effects) for effects in rungs]
    return Ladder(ladder[0], ladder, rounds=[[], []])


def tell(text):
    pass


def test_the_first_effect_is_exchanged_for_what_explains_more(residuals):
    search = climbed(residuals, [], [OTHER], [OTHER, OFFSET])
    before = search.rungs[-1].scores["heldout"].rmse
    exchanged(search, [FRICTION, OFFSET, OTHER], residuals, SETTINGS, tell)
    assert [r.effects for r in search.rungs] == [[], [OFFSET], [OFFSET, FRICTION]]
    last = search.rungs[-1]
    assert last.scores["heldout"].rmse < 0.3 * before
    for name, value in TRUE.items():
        assert last.fit.changes[name] == pytest.approx(value, rel=0.1)
    assert not set(parameters_of(OTHER)) & set(last.fit.changes)
    assert search.rounds[-1][0].effects == (FRICTION,)


def test_a_complete_pair_of_which_each_is_needed_stays(residuals):
    search = climbed(residuals, [], [OFFSET], [OFFSET, FRICTION])
    pair = search.rungs[-1]
    exchanged(search, [FRICTION, OFFSET, OTHER], residuals, SETTINGS, tell)
    pruned(search, residuals, SETTINGS, tell, None)
    assert search.rungs[-1] is pair


def test_what_is_not_needed_beside_the_latest_goes(residuals):
    search = climbed(residuals, [], [OTHER], [OTHER, OFFSET, FRICTION])
    pruned(search, residuals, SETTINGS, tell, None)
    assert search.rungs[-1].effects == [OFFSET, FRICTION]
