"""The search names the effect that made an arm's data, and nothing where nothing is missing."""

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from spirob.diagnosis.atlas import survey
from spirob.diagnosis.conclusion import weigh
from spirob.diagnosis.criteria import Settings, floor_at, noise_floor
from spirob.diagnosis.document import document, metrics
from spirob.diagnosis.fitting import Begun, begun
from spirob.diagnosis.schema import FORMAT, checked, unknown
from spirob.diagnosis.simulated import ROLES, Simulated
from spirob.diagnosis.verdict import SENSELESS, judge, searched
from spirob.effects import find_effects
from spirob.identify.builds import Floor, hinges, holes
from spirob.identify.fit import fit
from tests.identify.known import NOISE, residual, spirob

NAMES = ["winch.efficiency", "motor.rotor_damping", "arm.base_stiffness"]
OTHERS = {"winch.efficiency": 0.72, "motor.rotor_damping": 7e-5, "arm.base_stiffness": 0.17}
CANDIDATES = ["capstan_friction", "current_offset", "stiffness_hardening"]
SETTINGS = Settings(finalists=2, most=1, iterations=4, patience=6)


def trials(true, candidates=CANDIDATES):
    """Data by the model with the numbers `true`."""
    plant = spirob(find_effects(candidates))
    return {role: residual(plant, {**OTHERS, **true}, role) for role in ROLES}


def diagnosed(residuals, candidates=CANDIDATES, measure=None, start=None, settings=SETTINGS):
    """A search that starts at nominal numbers, or at a fit from there."""
    start = start or begun(residuals["train"], NAMES, {}, settings)
    models = Simulated(residuals, NAMES, settings, start, measure)
    return searched(models, find_effects(candidates), settings)


@pytest.fixture(scope="module")
def offset():
    """Data with an offset of 60 mA, and the fit of the usual numbers to them."""
    residuals = trials({"current_offset.offset": 0.06})
    return residuals, begun(residuals["train"], NAMES, {}, SETTINGS)


@pytest.fixture(scope="module")
def found_offset(offset):
    """A search over them, and its verdict."""
    return diagnosed(offset[0], start=offset[1])


def written(ended, verdict):
    return document(ended, verdict, {}, noise_floor(ended.search.models.train))


@pytest.fixture(scope="module")
def found_friction():
    """A search over data with friction at the holes, and its verdict."""
    return diagnosed(trials({"capstan_friction.friction": 0.1}))


@pytest.mark.parametrize(
    ("hidden", "value", "search"),
    [
        ("capstan_friction.friction", 0.1, "found_friction"),
        ("current_offset.offset", 0.06, "found_offset"),
    ],
)
def test_the_missing_effect_is_named_and_the_error_falls(request, hidden, value, search):
    ended, verdict = request.getfixturevalue(search)
    found, name = ended.found, hidden.split(".")[0]
    assert (verdict.kind, verdict.named) == ("named", [name])
    assert [e.name() for e in found.chosen.effects] == [name]
    assert found.chosen.heldout_square < 0.09 * found.rungs[0].heldout_square
    assert found.chosen.fit.estimates[hidden].value == pytest.approx(value, rel=0.1)
    told = written(ended, verdict)
    assert told["effects"][0]["name"] == name
    assert told["doubts"] == []
    assert [rung.get("ceiling", False) for rung in told["ladder"]] == [False, False, True]
    for rung in told["ladder"]:
        for role in ROLES:
            for score, (low, high) in rung["interval"][role].items():
                assert low < rung[role][score] < high
    first = told["candidates"][0]
    assert (first["name"], first["with"]) == (name, [])
    assert first["heldout_rmse"] == pytest.approx(np.sqrt(found.chosen.heldout_square))
    assert first["left_out_rmse"] == pytest.approx(np.sqrt(found.chosen.mean_square))
    assert {c["name"] for c in told["candidates"]} == set(CANDIDATES)
    few = metrics(ended, verdict)
    assert (few["effect"], few["before"]) == (name, told["ladder"][0]["heldout"])


def test_what_is_written_is_a_document(found_offset, monkeypatch):
    """As the pipeline writes it, of a floor that was measured; before and after it was a file."""
    ended, verdict = found_offset
    models, base = ended.search.models, ended.found.rungs[0].fit.changes
    train, floor = models.train, Floor(0.01, "measured.")
    monkeypatch.setattr(models, "measure", lambda found: floor)
    monkeypatch.setattr(models, "floor_of", lambda model: floor)
    plain = train.unweighted()
    where = survey(plain, base, plain(base)[plain.rows])
    told = checked(document(ended, verdict, where, noise_floor(train)))
    assert (told["format"], told["verdict"]) == (FORMAT, "named")
    assert told["floor"] == {"share": 0.01, "reason": "measured."}
    assert unknown(json.loads(json.dumps(told))) == ""
    for part in ("floor", "depends", "vague", "effects", "atlas"):
        assert unknown({**told, part: 1}).startswith(f"{part}: ")


def test_whoever_doubts_gets_no_name_and_the_document_says_why(found_offset):
    """The models are those of a search without doubts, which fits the same."""
    doubts = ["The motors are exchanged."]
    models = found_offset[0].search.models
    ended, verdict = searched(models, find_effects(CANDIDATES), SETTINGS, doubts=doubts)
    told = written(ended, verdict)
    assert (told["verdict"], told["sentence"], told["doubts"]) == ("unknown", SENSELESS, doubts)
    assert told["effects"] == []
    assert (metrics(ended, verdict)["effect"], verdict.probability) == ("", 0.0)
    assert told["evidence"][0]["name"] == "current_offset"


def test_wrong_numbers_are_not_a_missing_effect():
    ended, verdict = diagnosed(trials({}))
    assert verdict.kind == "nothing_missing"
    assert ended.found.chosen.effects == ()


def test_an_effect_outside_the_candidates_is_unknown():
    residuals = trials({"cogging.sine": 0.006, "cogging.order": 2.0}, ["cogging", "current_offset"])
    assert diagnosed(residuals, ["current_offset"])[1].kind == "unknown"


def test_the_noise_floor_is_the_sensors():
    data = residual(spirob(), OTHERS)
    passed = np.std(data.filter(np.random.default_rng(1).standard_normal(20_000)))
    assert noise_floor(data) == pytest.approx(NOISE * passed, rel=0.2)


@pytest.mark.parametrize(
    ("alone", "with_it", "said"),
    [(0.5, 0.004, "named"), (0.004, 0.5, "named"), (0.5, 0.5, "nothing_missing")],
)
def test_an_effect_has_to_beat_the_lower_of_both_floors(alone, with_it, said, offset):
    """Of the machine without it and of the one that has it; without a name the first stands."""

    def measure(found):
        there = any(n.split(".")[0] in CANDIDATES for n in found.estimates)
        return Floor(with_it if there else alone, "so it was measured.")

    brief = replace(SETTINGS, intervals=False)
    ended, verdict = diagnosed(offset[0], start=offset[1], measure=measure, settings=brief)
    assert verdict.kind == said
    share = min(alone, with_it) if said == "named" else alone
    told = written(ended, verdict)
    assert told["floor"] == {"share": share, "reason": "so it was measured."}


def test_a_typical_build_lacks_nothing_and_gets_no_name():
    """Its hinges and holes are off, and it leaves more than the model's own resolution."""
    plant, rng = spirob(find_effects(CANDIDATES)), np.random.default_rng(11)
    built = plant.scattered(hinges(rng, 24), holes(rng, 24))
    found = {role: residual(built, OTHERS, role) for role in ROLES}
    residuals = {role: replace(of, plant=plant) for role, of in found.items()}

    def measure(found):
        return floor_at(found, residuals, SETTINGS.scale)

    assert diagnosed(residuals, measure=measure)[1].kind == "nothing_missing"


FEW = ["winch.efficiency", "arm.base_stiffness"]
TWO = find_effects(["capstan_friction", "current_offset"])


@cache
def valley(friction):
    """Data with friction at the holes, and a poor valley: four times the stiffness that fits."""
    plant, true = spirob(TWO), {"capstan_friction.friction": friction}
    residuals = {role: residual(plant, true, role) for role in ROLES}
    found = fit(residuals["train"], FEW, {}, 0.05, 3, exact=False)
    far = found.changes | {"arm.base_stiffness": 4.0 * found.changes["arm.base_stiffness"]}
    return residuals, replace(
        found, changes=far, residual=residuals["train"](far), cost=100.0 * found.cost
    )


def astray(friction, most):
    """A search that begins in a poor valley."""
    residuals, poor = valley(friction)
    settings = Settings(intervals=False, always=False, most=most)
    models = Simulated(residuals, FEW, settings, Begun(poor))
    before, told = models.fitted((), {}), []
    ended, verdict = searched(models, TWO, settings, told.append)
    return before, ended, verdict, told


@pytest.mark.parametrize("most", [1, 2])
def test_what_was_ranked_in_a_poor_valley_is_ranked_again(most):
    before, ended, _, told = astray(0.04, most)
    chosen, bare = ended.found.chosen, ended.found.rungs[0]
    assert [e.name() for e in chosen.effects] == ["capstan_friction"]
    assert bare.mean_square < 0.25 * before.mean_square
    assert bare is ended.search.models.tried[frozenset()]
    ranked = [k for k, line in enumerate(told) if "screened beside the fitted numbers" in line]
    again = [k for k, line in enumerate(told) if line.startswith("the fitted numbers alone:")]
    assert ranked[0] < again[0] < ranked[1]
    assert len(again) == 1


@pytest.mark.parametrize("most", [1, 2])
def test_what_only_led_the_numbers_out_of_a_poor_valley_is_no_effect(most):
    before, ended, verdict, _ = astray(0.0, most)
    assert ended.found.chosen.effects == ()
    assert ended.found.chosen.mean_square < 0.25 * before.mean_square
    assert verdict.kind == "nothing_missing"


def test_a_second_search_without_some_names_is_as_if_they_had_never_been(offset, found_offset):
    """The fit of the numbers alone is taken over, what was screened beside it, and no more."""
    (residuals, start), (first, verdict) = offset, found_offset
    models = first.search.models
    assert verdict.named == ["current_offset"]
    rest = [n for n in CANDIDATES if n != "current_offset"]
    again = searched(models.without({"current_offset"}), find_effects(rest), SETTINGS)[1]
    assert "current_offset" not in {*again.named, *again.rivals, *again.equivalents}
    alone = searched(Simulated(residuals, NAMES, SETTINGS, start), find_effects(rest), SETTINGS)[1]
    assert (again.kind, again.named) == (alone.kind, alone.named)
    assert judge(first, weigh(first)) == verdict


@pytest.fixture(scope="module")
def few():
    """Data with an offset, and the fit of two numbers to them, at nominal numbers for the rest."""
    plant, true = spirob(find_effects(CANDIDATES)), {"current_offset.offset": 0.06}
    brief = replace(SETTINGS, intervals=False, patience=3)
    residuals = {role: residual(plant, true, role) for role in ROLES}
    return residuals, begun(residuals["train"], NAMES[:2], {}, brief)


def test_what_the_screening_promises_little_of_is_fitted_all_the_same(few):
    """The offset makes 4.6 % of the effort once it is fitted, of which the screening sees 0.6 %,
    less than the 2 % that count."""
    (residuals, start), names, effects = few, NAMES[:2], find_effects(CANDIDATES)
    settings = replace(SETTINGS, finalists=3, intervals=False)
    models = Simulated(residuals, names, settings, start, lambda found: Floor(0.02, ""))
    verdict = searched(models, effects, settings)[1]
    assert (verdict.kind, verdict.named) == ("named", ["current_offset"])


@pytest.mark.parametrize("faster", [3e-4, 0.0])
def test_a_wave_as_slow_as_its_bounds_allow_needs_faster_ones_that_count(faster):
    plant = spirob(find_effects(["cogging"]))
    low = plant.table.about["cogging.order"].low
    waves = {"sine": 3e-4, "second_sine": faster, "order": low, "ratio": 20.0}
    waves = {f"cogging.{name}": value for name, value in waves.items()}
    residuals = trials(waves, ["cogging"])
    start = begun(residuals["train"], NAMES, {}, SETTINGS)
    models = Simulated(residuals, NAMES, SETTINGS, start)
    model = models.fitted(tuple(find_effects(["cogging"])), waves)
    assert model.mean_square < 0.1 * models.fitted((), {}).mean_square
    assert models.plain(model) == (faster > 0.0)
