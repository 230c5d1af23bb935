"""The figures of a name: what a search shows of it, and what says most of the same."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spirob.diagnosis.certainty import FIGURES, LEARNED, MOST, figures, kin, probability, sharp
from spirob.effects import find_effects
from spirob.identify.fit import fit
from tests.diagnosis.machines import SAMPLES, ended, model
from tests.identify.linear import Linear as Nearly

EFFECT, OTHER, THIRD = find_effects(["coulomb_friction", "presliding_friction", "cogging"])
BARE = model([], 0.010)
WAVE = np.tile([1.0, -1.0], SAMPLES // 2)


def found(heldout=0.002, share=0.5, half=0.05, beside=()):
    """The effect takes 10 mA to 2 where that decides, and to `heldout` on the held-out trials."""
    return ended(BARE, *beside, model([EFFECT], 0.002, heldout, half=half), share=share)


def shown(*given, **told):
    return figures(found(*given, **told), EFFECT)


def test_figures_are_of_the_held_out_errors():
    told = shown(0.006)
    fall = np.log((0.010 / 0.006) ** 2)
    assert told["fall_heldout"] == pytest.approx(fall, rel=1e-5)
    assert told["ahead_heldout"] == pytest.approx(fall, rel=1e-5)  # none was tried besides
    assert told["left"] == pytest.approx(np.log(0.5 * 0.002**2 / (0.010**2 - 0.002**2)), rel=1e-5)
    assert {*told, "share"} == {name for names in FIGURES.values() for name in names}
    assert shown(share=0.0)["left"] == -MOST


def test_the_best_other_that_says_something_else_is_what_a_name_is_ahead_of():
    far = np.full(SAMPLES, 0.01)
    rival = model([OTHER], 0.003, 0.003, far)
    assert shown(0.002, beside=[rival])["ahead_heldout"] == pytest.approx(2 * np.log(1.5), rel=1e-5)
    twin = replace(rival, fit=replace(rival.fit, residual=np.full(SAMPLES, 0.002)))
    assert shown(0.002, beside=[twin]) == shown(0.002)
    richer = model([OTHER, THIRD], 0.003, 0.003, far)
    assert shown(0.002, beside=[richer]) == shown(0.002), "it holds two"
    both = model([OTHER, EFFECT], 0.003, 0.003, far)
    assert shown(0.002, beside=[both]) == shown(0.002), "it holds the name itself"


@pytest.mark.parametrize(("apart", "of_kin"), [(0.003, True), (0.01, False)])
def test_of_its_kin_an_effect_is_not_ahead(apart, of_kin):
    """What makes most of the same is no other explanation; the bare model is the next."""
    told = shown(0.002, beside=[model([OTHER], 0.003, 0.003, np.full(SAMPLES, apart))])
    assert told["ahead_heldout"] == pytest.approx(2 * np.log(1.5), rel=1e-5)
    assert told["ahead_of_kin"] == pytest.approx(2 * np.log(5.0 if of_kin else 1.5), rel=1e-5)


def test_the_place_is_that_of_the_rung():
    first, last = model([EFFECT], 0.004), model([EFFECT, OTHER], 0.002)
    both = ended(BARE, first, model([OTHER], 0.008), last)
    assert [figures(both, e)["place"] for e in (EFFECT, OTHER)] == [0.0, 1.0]
    assert figures(both, EFFECT)["fall_heldout"] == pytest.approx(2 * np.log(4.0), rel=1e-5)


def test_an_effect_is_weighed_against_the_chosen_model_without_it():
    """Whatever was tried on the way: what made another needless is ahead of the bare model."""
    way = ended(
        BARE, model([OTHER], 0.004), model([OTHER, EFFECT], 0.0038), model([EFFECT], 0.0038)
    )
    told = figures(way, EFFECT)
    assert told["fall_heldout"] == pytest.approx(2 * np.log(0.010 / 0.0038), rel=1e-5)
    assert told["place"] == 0.0


def test_the_sharper_its_number_the_surer_a_name():
    vague, clear = (probability(shown(0.003, half=half), "creep") for half in (0.8, 0.02))
    assert vague < clear


@pytest.mark.parametrize(
    ("certainty", "bound", "shape", "held"),
    [
        ("name", True, False, True),
        ("name", False, False, False),
        ("name", False, True, True),
        ("arm", True, True, False),
    ],
)
def test_a_number_at_a_bound_or_a_shape_makes_no_amplitude_of_a_rig_unsure(
    certainty, bound, shape, held
):
    problem = Nearly([0.1, 0.1], [1.0, 1.0], 1e-3)
    problem.slopes[:, 1] = 0.95 * problem.slopes[:, 0] + 0.05 * problem.slopes[:, 1]
    own, other = problem.names
    both = fit(problem, problem.names, {}, 0.05)
    ended_there = replace(both.estimates[other], at_bound=bound)
    both = replace(both, estimates={**both.estimates, other: ended_there})
    law, field = own.split(".")
    fields = [field, other.split(".")[1]] if shape else [field]
    effect = SimpleNamespace(name=lambda: law, neutral={field: 0.0}, fitted=lambda: fields)
    models = SimpleNamespace(train=problem, names=[other], certainty=certainty, robust=0.05)
    alone = fit(problem, [own], {other: both.changes[other]}, 0.05).estimates[own]
    wanted = alone if held else both.estimates[own]
    expected = np.log(wanted.value / (0.5 * (wanted.high - wanted.low)))
    assert sharp(models, both, effect) == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("absent", [True, False])
def test_an_amplitude_at_its_neutral_bound_makes_the_other_of_its_law_no_less_sure(absent):
    problem = Nearly([0.1, 0.1], [1.0, 1.0], 1e-3)
    problem.slopes[:, 1] = 0.95 * problem.slopes[:, 0] + 0.05 * problem.slopes[:, 1]
    own, other = problem.names
    both = fit(problem, problem.names, {}, 0.05)
    bound = problem.table.about[other].low
    there = replace(both.estimates[other], value=bound, at_bound=True)
    both = replace(both, estimates={**both.estimates, other: there})
    neutral = {own.split(".")[1]: 0.0, other.split(".")[1]: bound if absent else bound - 1e-6}
    law = own.split(".")[0]
    effect = SimpleNamespace(name=lambda: law, neutral=neutral, fitted=lambda: list(neutral))
    models = SimpleNamespace(train=problem, names=[], certainty="name", robust=0.05)
    alone = fit(problem, [own], {other: both.changes[other]}, 0.05).estimates[own]
    wanted = alone if absent else both.estimates[own]
    expected = np.log(wanted.value / (0.5 * (wanted.high - wanted.low)))
    assert sharp(models, both, effect) == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize(("certainty", "sure"), [("name", False), ("arm", True)])
def test_an_amplitude_that_ended_at_a_cap_of_its_own_makes_no_name_of_a_rig_sure(certainty, sure):
    problem = Nearly([0.1, 0.1], [1.0, 1.0], 1e-3)
    own = problem.names[0]
    found = fit(problem, problem.names, {}, 0.05)
    cap = problem.table.about[own].high
    there = replace(found.estimates[own], value=cap, low=0.99 * cap, high=cap, at_bound=True)
    found = replace(found, estimates={**found.estimates, own: there})
    law, field = own.split(".")
    effect = SimpleNamespace(name=lambda: law, neutral={field: 0.0}, fitted=lambda: [field])
    models = SimpleNamespace(train=problem, names=[], certainty=certainty, robust=0.05)
    assert sharp(models, found, effect) == pytest.approx(np.log(200.0) if sure else 0.0)


def test_more_of_what_speaks_for_a_name_makes_it_likelier():
    for of, names in FIGURES.items() - {("proof", FIGURES["proof"])}:
        middle = dict(zip(names, LEARNED[of]["mean"], strict=True))
        for figure in (*names[:2], "sharp"):
            more = middle | {figure: middle[figure] + 1.0}
            assert probability(more, "creep", of) > probability(middle, "creep", of)
        more = middle | {"left": middle["left"] + 1.0}
        assert probability(more, "creep", of) < probability(middle, "creep", of)


@pytest.mark.parametrize(
    ("apart", "far", "said"),
    [(0.1, 0.9, [OTHER]), (0.2, 0.1, [OTHER, THIRD]), (0.9, 0.9, [])],
    ids=["one", "both", "none"],
)
def test_what_makes_most_of_an_effect_is_of_its_kin(apart, far, said):
    """Of a law of one, by half the square that it takes; the best on held-out trials first."""
    near, third = model([OTHER], 1.0, 0.11, apart * WAVE), model([THIRD], 1.0, 0.12, far * WAVE)
    chosen = model([EFFECT], 0.0, 0.1, 0.0 * WAVE)
    one = ended(model([], 1.0), near, third, chosen)
    assert kin(one.search, one.found, EFFECT) == [e.name() for e in said]


def test_what_the_held_out_trials_refute_is_of_no_kin():
    near = model([OTHER], 1.0, 0.5, 0.1 * WAVE)
    chosen = model([EFFECT], 0.0, 0.1, 0.0 * WAVE)
    one = ended(model([], 1.0), near, chosen)
    assert kin(one.search, one.found, EFFECT) == []


def test_its_kin_on_its_rung_is_its_kin_beside_lesser_effects_too():
    """What was added since hardly fits beside the other one."""
    near, rung = model([OTHER], 1.0, 0.2, 0.1 * WAVE), model([EFFECT], 0.1, 0.2, 0.0 * WAVE)
    beside = model([THIRD], 0.9, 0.9, 0.9 * WAVE)
    refuted = model([OTHER, THIRD], 1.0, 0.9, 0.0 * WAVE)
    chosen = model([EFFECT, THIRD], 0.0, 0.1, 0.0 * WAVE)
    one = ended(model([], 1.0), near, beside, refuted, rung, chosen)
    found = replace(one.found, rungs=[one.found.rungs[0], rung, chosen])
    assert kin(one.search, found, EFFECT) == [OTHER.name()]
    assert kin(one.search, replace(found, rungs=[*found.rungs[:1], chosen]), EFFECT) == []
