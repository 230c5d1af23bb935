"""The probability of a name: learned from the committed cases, true on simulators left out."""

from pathlib import Path

import numpy as np
import pytest

from spirob.campaign.calibration import calibration_error, digest, effects, learned, left_out, read
from spirob.diagnosis.certainty import FIGURES, LEARNED, probability

FOLDER = Path(__file__).parents[2] / "reports"


def paths(of):
    return [FOLDER / name for name in LEARNED[of]["cases"]]


@pytest.fixture(scope="module", params=FIGURES)
def of(request):
    return request.param


@pytest.fixture(scope="module")
def cases(of):
    return effects(read(paths(of)), of)


def test_what_ships_is_what_the_cases_say(cases, of):
    rows, right, whose = cases
    fit = learned(rows, right, whose)
    assert digest(paths(of)) == LEARNED[of]["sha256"]
    assert LEARNED[of]["figures"] == list(FIGURES[of])
    for name, value in fit.items():
        np.testing.assert_allclose(LEARNED[of][name], value, rtol=1e-5, atol=1e-7)


def test_the_probability_is_that_of_the_regression(cases, of):
    rows, right, whose = cases
    fit = learned(rows, right, whose)
    for row in rows[:20]:
        told = probability(dict(zip(FIGURES[of], row, strict=True)), of)
        score = fit["bias"] + np.dot(fit["weights"], (row - fit["mean"]) / fit["scale"])
        assert told == pytest.approx(1 / (1 + np.exp(-score)), rel=1e-6)


SQUARE = {
    "name": 0.5,
    "arm": 0.7,
    "kin": 0.65,
}  # of the error of who states the rate of all cases each time


def test_it_holds_on_simulators_or_robots_that_it_was_not_fitted_to(cases, of):
    """Names that are told with 90 % and more are seldom wrong; the mean rate is far worse."""
    rows, right, whose = cases
    stated = left_out(rows, right, whose)
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
    more = np.concatenate([np.arange(300), np.arange(100)])  # all of `one` twice
    few, many = (learned(rows[k], right[k], simulators[k]) for k in (np.arange(300), more))
    for fit in (few, many):  # numbers of the raw figures, whatever they were scaled by
        fit["slopes"] = np.array(fit["weights"]) / fit["scale"]
    assert few["slopes"] == pytest.approx(many["slopes"], abs=0.02)
