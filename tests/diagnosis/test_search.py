"""The search names the effect that made the data, and nothing where nothing is missing."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.diagnosis.document import document, metrics
from spirob.diagnosis.evidence import noise_floor
from spirob.diagnosis.ladder import climb
from spirob.diagnosis.rungs import ROLES, Settings, floor_at
from spirob.diagnosis.verdict import judge
from spirob.effects import find_effects
from spirob.identify.builds import Floor, hinges, holes
from tests.identify.known import NOISE, residual, spirob

NAMES = ["winch.efficiency", "motor.rotor_damping", "arm.base_stiffness"]
OTHERS = {"winch.efficiency": 0.72, "motor.rotor_damping": 7e-5, "arm.base_stiffness": 0.17}
CANDIDATES = ["capstan_friction", "current_offset", "stiffness_hardening"]
SETTINGS = Settings(finalists=2, rounds=1, iterations=4, patience=6)


def diagnose(true):
    """Data by the model with the numbers `true`; the search starts at nominal numbers."""
    plant = spirob(find_effects(CANDIDATES))
    residuals = {role: residual(plant, {**OTHERS, **true}, role) for role in ROLES}
    search = climb(residuals, NAMES, find_effects(CANDIDATES), {}, SETTINGS)
    return search, judge(search, residuals, SETTINGS), residuals


@pytest.mark.parametrize(
    ("hidden", "value"), [("capstan_friction.friction", 0.1), ("current_offset.offset", 0.06)]
)
def test_the_missing_effect_is_named_and_the_error_falls(hidden, value):
    search, verdict, residuals = diagnose({hidden: value})
    name = hidden.split(".")[0]
    assert verdict.kind == "named"
    assert [e.name() for e in search.rungs[1].effects] == [name]
    before, after = search.rungs[0].scores["heldout"].rmse, search.rungs[1].scores["heldout"].rmse
    assert after < 0.3 * before
    assert search.rungs[1].fit.estimates[hidden].value == pytest.approx(value, rel=0.1)
    train = residuals["train"]
    written = document(search, verdict, {}, noise_floor(train), residuals)
    assert written["effects"][0]["name"] == name
    assert [rung.get("ceiling", False) for rung in written["ladder"]] == [False, False, True]
    for rung in written["ladder"]:
        for role in ROLES:
            for score, (low, high) in rung["interval"][role].items():
                assert low < rung[role][score] < high
    assert metrics(search, verdict, train.effort)["effect"] == name


def test_wrong_numbers_are_not_a_missing_effect():
    search, verdict, _ = diagnose({})
    assert verdict.kind == "nothing_missing"
    assert len(search.rungs) == 1


def test_an_effect_outside_the_candidates_is_unknown():
    plant = spirob(find_effects(["cogging", "current_offset"]))
    true = {**OTHERS, "cogging.sine": 0.006, "cogging.order": 2.0}
    residuals = {role: residual(plant, true, role) for role in ROLES}
    search = climb(residuals, NAMES, find_effects(["current_offset"]), {}, SETTINGS)
    assert judge(search, residuals, SETTINGS).kind == "unknown"


def test_the_noise_floor_is_the_sensors():
    data = residual(spirob(), OTHERS)
    passed = np.std(data.filter(np.random.default_rng(1).standard_normal(20_000)))
    assert noise_floor(data) == pytest.approx(NOISE * passed, rel=0.2)


@pytest.mark.parametrize(
    ("alone", "with_it", "said"),
    [(0.5, 0.004, "named"), (0.004, 0.5, "named"), (0.5, 0.5, "nothing_missing")],
)
def test_an_effect_has_to_beat_the_lower_of_both_floors(alone, with_it, said):
    """Of the machine without it and of the one that has it; without a name the first stands."""
    plant = spirob(find_effects(CANDIDATES))
    true = {**OTHERS, "current_offset.offset": 0.06}
    residuals = {role: residual(plant, true, role) for role in ROLES}

    def measure(found):
        there = any(n.split(".")[0] in CANDIDATES for n in found.estimates)
        return Floor(with_it if there else alone, "so it was measured.")

    search = climb(residuals, NAMES, find_effects(CANDIDATES), {}, SETTINGS, measure=measure)
    settings = search.settings(SETTINGS)
    assert settings.floor == (min(alone, with_it) if said == "named" else alone)
    verdict = judge(search, residuals, settings)
    assert verdict.kind == said
    written = document(search, verdict, {}, noise_floor(residuals["train"]), residuals)
    assert written["floor"] == {"share": settings.floor, "reason": "so it was measured."}


def test_a_typical_build_lacks_nothing_and_gets_no_name():
    """Its hinges and holes are off, and it leaves more than the model's own resolution."""
    plant, rng = spirob(find_effects(CANDIDATES)), np.random.default_rng(11)
    built = plant.scattered(hinges(rng, 24), holes(rng, 24))
    found = {role: residual(built, OTHERS, role) for role in ROLES}
    residuals = {role: replace(of, plant=plant) for role, of in found.items()}

    def measure(found):
        return floor_at(found, residuals, SETTINGS.scale)

    search = climb(residuals, NAMES, find_effects(CANDIDATES), {}, SETTINGS, measure=measure)
    assert judge(search, residuals, search.settings(SETTINGS)).kind == "nothing_missing"
