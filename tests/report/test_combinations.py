"""Combinations of effects: one alone as simulated, several to first order, none the base model."""

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest

from spirob.report.combinations import combinations, widened
from spirob.report.sections.switches import Switches
from tests.report.synthetic import DIAGNOSIS

TIME = np.arange(0, 8, 0.01)
DRIVEN = {("a", "left"), ("b", "left")}
FIRST, SECOND = np.sin(2 * TIME), np.cos(5 * TIME)


def tables():
    """A robot whose current is base + first + half of second; candidates are each whole."""
    overlay, finalists = [], []
    for trial, role in (("a", "validate"), ("b", "heldout")):
        stroke = 0.03 * (1 - np.cos(TIME))
        about = {"trial": trial, "role": role, "motor": "left", "time": TIME}
        overlay.append(
            pd.DataFrame(
                about
                | {
                    "measured_current": 2.0 + FIRST + 0.5 * SECOND,
                    "base_current": 2.0,
                    "named_current": 2.0 + 1.1 * FIRST,
                    "measured_displacement": stroke,
                    "measured_velocity": np.gradient(stroke, TIME),
                }
            )
        )
        for name, change in (("first", FIRST), ("second", SECOND)):
            rest = {"effect": name, "current": 2.0 + change, "displacement": 0.0, "velocity": 0.0}
            finalists.append(pd.DataFrame(about | rest))
    return widened(pd.concat(overlay), pd.concat(finalists).sample(frac=1.0, random_state=1))


@pytest.fixture(scope="module")
def found():
    return {c.effects: c for c in combinations(tables(), ["first", "second"], DRIVEN, {"first"})}


def rms(signal):
    return float(np.sqrt(np.mean(signal**2)))


def test_every_subset_is_there(found):
    assert list(found) == [(), ("first",), ("second",), ("first", "second")]


def test_none_is_the_base_model(found):
    assert found[()].rmse["heldout"] == pytest.approx(rms(FIRST + 0.5 * SECOND))


def test_the_verdict_is_its_own_model(found):
    assert found[("first",)].weights is None
    assert found[("first",)].rmse["heldout"] == pytest.approx(rms(0.1 * FIRST - 0.5 * SECOND))


def test_one_alone_is_taken_whole(found):
    assert found[("second",)].weights == {"second": 1.0}
    assert found[("second",)].rmse["heldout"] == pytest.approx(rms(0.5 * SECOND - FIRST))
    assert found[("second",)].full


def test_several_are_a_sum_with_fitted_shares(found):
    both = found[("first", "second")]
    assert both.weights == pytest.approx({"first": 1.0, "second": 0.5}, abs=1e-6)
    assert both.rmse["heldout"] < 1e-6
    assert not both.full


def test_regimes_are_those_of_the_motion(found):
    regimes = found[()].regimes
    inward, outward = np.sin(TIME) > 1 / 30, np.sin(TIME) < -1 / 30
    off = FIRST + 0.5 * SECOND
    assert regimes["winding in"] == pytest.approx(rms(off[inward]), rel=0.02)
    assert regimes["paying out"] == pytest.approx(rms(off[outward]), rel=0.02)


def test_motors_whose_current_is_commanded_do_not_count():
    assert combinations(tables(), ["first"], set()) == []


def test_five_effects_are_the_most():
    wide = tables()
    names = [f"e{k}" for k in range(7)]
    for k, name in enumerate(names):
        wide[f"{name}_current"] = 2.0 + np.tile(np.sin((k + 1) * TIME), 2)
    assert len(combinations(wide, names, DRIVEN)) == 2**5


def test_more_effects_never_fit_the_validation_trials_worse(found):
    errors = [found[key].rmse["validate"] for key in [("second",), ("first", "second")]]
    assert all(later <= before for before, later in pairwise(errors))


def test_the_named_effect_of_the_run_is_switched_on(data):
    context = Switches().get_context(data)
    on = [switch["name"] for switch in context["switches"] if switch["on"]]
    assert on == [effect["name"] for effect in DIAGNOSIS["effects"]]
    assert len(context["combinations"]) == len(context["rows"]) == 8
