"""The probability of a name: learned from the committed cases, true on simulators left out."""

from pathlib import Path

import numpy as np
import pytest

from spirob.campaign.calibration import (
    OF_PROOF,
    STRENGTH,
    Names,
    calibration_error,
    digest,
    effects,
    learned,
    left_out,
    read,
)
from spirob.diagnosis.certainty import FIGURES, LEARNED, probability, proven

FOLDER = Path(__file__).parents[2] / "reports"


def paths(of):
    return [FOLDER / name for name in LEARNED[of]["cases"]]


@pytest.fixture(scope="module", params=FIGURES)
def of(request):
    return request.param


@pytest.fixture(scope="module")
def cases(of):
    return effects(read(paths(of)), of)


@pytest.fixture(scope="module")
def strength(of):
    return OF_PROOF if of == "proof" else STRENGTH


def test_what_ships_is_what_the_cases_say(cases, of, strength):
    fit = learned(cases, strength)
    assert digest(paths(of)) == LEARNED[of]["sha256"]
    assert LEARNED[of]["figures"] == list(FIGURES[of])
    assert LEARNED[of]["names"] == pytest.approx(fit.pop("names"), rel=1e-5, abs=1e-7)
    for name, value in fit.items():
        np.testing.assert_allclose(LEARNED[of][name], value, rtol=1e-5, atol=1e-7)


def test_the_probability_is_that_of_the_regression(cases, of, strength):
    fit = learned(cases, strength)
    for row, name in zip(cases.rows[:20], cases.names[:20], strict=True):
        figures = dict(zip(FIGURES[of], row, strict=True))
        score = fit["bias"] + np.dot(fit["weights"], (row - fit["mean"]) / fit["scale"])
        for called, own in ((name, fit["names"].get(name, 0.0)), ("my_own_effect", 0.0)):
            told = probability(figures, called, of)
            assert told == pytest.approx(1 / (1 + np.exp(-score - own)), rel=1e-6)


def test_a_proof_changes_the_odds_of_all_cases_to_those_of_its_share():
    cases = effects(read(paths("proof")), "proof")
    assert set(cases.names) == {""}
    for share in np.unique(cases.rows[:, 0])[::20]:
        told = proven(float(np.mean(cases.right)), share)
        assert told == pytest.approx(probability({"share": share}, "", "proof"), rel=1e-6)
    assert proven(0.9, -2.0) == proven(0.9, 0.0) < proven(0.9, 0.5) < 0.9 < proven(0.9, 1.0)
    assert (proven(0.0, 1.0), proven(1.0, 0.5)) == (0.0, 1.0)


SQUARE = {
    "name": 0.5,
    "arm": 0.7,
    "kin": 0.65,
    "proof": 0.75,
}  # of the error of who states the rate of all cases each time


def test_it_holds_on_simulators_or_robots_that_it_was_not_fitted_to(cases, of, strength):
    """Names that are told with 90 % and more are seldom wrong; the mean rate is far worse."""
    stated, right = left_out(cases, strength), cases.right
    sure = stated >= 0.9
    assert sure.sum() > 0.2 * len(right)
    assert np.mean(~right[sure]) < 0.1
    assert np.mean((stated - right) ** 2) < SQUARE[of] * np.mean(right) * np.mean(~right)


def test_stated_rates_that_are_found_have_no_error():
    rng = np.random.default_rng(1)
    stated = rng.uniform(0, 1, 40_000)
    assert calibration_error(stated, rng.uniform(0, 1, 40_000) < stated) < 0.02
    assert calibration_error(np.ones(100), np.zeros(100, bool)) == 1.0


def test_a_simulator_that_was_played_more_often_weighs_no_more():
    rng = np.random.default_rng(3)
    rows, simulators = rng.standard_normal((300, 6)), np.repeat(["one", "two"], [100, 200])
    right = rng.uniform(size=300) < 1 / (1 + np.exp(-rows[:, 0]))
    drawn = Names(rows, np.repeat("friction", 300), right, simulators)
    more = np.concatenate([np.arange(300), np.arange(100)])  # all of `one` twice
    few, many = (learned(drawn.of(k)) for k in (np.arange(300), more))
    for fit in (few, many):  # numbers of the raw figures, whatever they were scaled by
        fit["slopes"] = np.array(fit["weights"]) / fit["scale"]
    assert few["slopes"] == pytest.approx(many["slopes"], abs=0.02)


def test_a_name_that_is_oftener_right_than_others_like_it_is_surer_and_a_rare_one_is_not():
    """Of three alike in their figures one is right in 90 % of many cases, one in three of three."""
    rng = np.random.default_rng(4)
    names = np.array(["often"] * 400 + ["seldom"] * 400 + ["rare"] * 3)
    rate = np.array([0.9] * 400 + [0.3] * 400 + [1.0] * 3)
    right = rng.uniform(size=len(names)) < rate
    fit = learned(Names(rng.standard_normal((803, 6)), names, right, np.repeat("one", 803)))
    told = {n: 1 / (1 + np.exp(-fit["bias"] - own)) for n, own in fit["names"].items()}
    assert told["often"] == pytest.approx(0.9, abs=0.05)
    assert told["seldom"] == pytest.approx(0.3, abs=0.05)
    assert told["seldom"] < told["rare"] < told["often"]


def test_disturbed_machines_weigh_as_one_more_simulator_and_are_judged_with_theirs():
    """Twice as many of one simulator's change nothing, but twice of two simulators' together do."""
    rng = np.random.default_rng(5)
    whose = np.repeat(["one", "two", "disturbed/one", "disturbed/two"], 100)
    rows = rng.standard_normal((400, 6))
    right = np.where(np.char.startswith(whose, "disturbed"), rows[:, 0] > -1.0, rows[:, 0] > 1.0)
    drawn = Names(rows, np.repeat("friction", 400), right, whose)
    once, twice = learned(drawn), learned(drawn.of(np.r_[:400, 200:400]))
    assert twice["bias"] == pytest.approx(once["bias"], rel=0.05)
    alone = learned(drawn.of(np.array([w.endswith("two") for w in whose])))
    scaled = (rows[:100] - alone["mean"]) / alone["scale"]
    score = scaled @ alone["weights"] + alone["bias"] + alone["names"]["friction"]
    np.testing.assert_allclose(left_out(drawn)[:100], 1 / (1 + np.exp(-score)), rtol=1e-6)
