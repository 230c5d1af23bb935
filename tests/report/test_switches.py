"""Combinations of effects: as they were played, the verdict's by its own model, none the base."""

import numpy as np
import pandas as pd
import pytest

from spirob.report.sections.switches import Switches, combinations, key, played, switchable, widened
from tests.report.synthetic_results import DIAGNOSIS

TIME = np.arange(0, 8, 0.01)
DRIVEN = {("a", "left"), ("b", "left")}
FIRST, SECOND = np.sin(2 * TIME), np.cos(5 * TIME)
CHANGES = {
    "first": ("refitted", FIRST),
    "second": ("screened", SECOND),
    "first + second": ("replayed", FIRST + 0.4 * SECOND),
}


def tables():
    """A robot whose current is base + first + half of second."""
    overlay, responses = [], []
    for trial, role in (("a", "validate"), ("b", "heldout")):
        stroke = 0.03 * (1 - np.cos(TIME))
        about = {"trial": trial, "role": role, "motor": "left", "time": TIME}
        measured = {
            "measured_current": 2.0 + FIRST + 0.5 * SECOND,
            "base_current": 2.0,
            "named_current": 2.0 + 1.1 * FIRST,
            "measured_displacement": stroke,
            "measured_velocity": np.gradient(stroke, TIME),
        }
        overlay.append(pd.DataFrame(about | measured))
        for effects, (how, change) in CHANGES.items():
            rest = {"effects": effects, "how": how, "displacement": 0.0, "velocity": 0.0}
            responses.append(pd.DataFrame(about | rest | {"current": 2.0 + change}))
    shuffled = pd.concat(responses).sample(frac=1.0, random_state=1)
    shuffled["effects"] = shuffled["effects"].astype("category")
    return widened(pd.concat(overlay), shuffled)


@pytest.fixture(scope="module")
def found():
    return {c.effects: c for c in combinations(tables(), ["first", "second"], DRIVEN, {"first"})}


def rms(signal):
    return float(np.sqrt(np.mean(signal**2)))


def test_every_subset_is_there(found):
    assert list(found) == [(), ("first",), ("second",), ("first", "second")]


def test_none_is_the_base_model(found):
    assert found[()].how == "base"
    assert found[()].rmse["heldout"] == pytest.approx(rms(FIRST + 0.5 * SECOND))


def test_the_verdict_is_its_own_model(found):
    assert found[("first",)].how == "verdict"
    assert found[("first",)].column == "named"
    assert found[("first",)].rmse["heldout"] == pytest.approx(rms(0.1 * FIRST - 0.5 * SECOND))


def test_the_others_are_as_they_were_played(found):
    assert found[("second",)].how == "screened"
    assert found[("second",)].rmse["heldout"] == pytest.approx(rms(0.5 * SECOND - FIRST))
    both = found[("first", "second")]
    assert both.how == "replayed"
    assert both.rmse["heldout"] == pytest.approx(rms(0.1 * SECOND))


def test_a_combination_is_found_in_any_order(found):
    assert key(["second", "first"]) == found[("first", "second")].column
    assert set(played(tables())) == {"first", "second", "first + second"}


def test_a_combination_that_was_not_played_is_left_out():
    wide = tables()
    del wide.attrs["how"]["first + second"]
    kept = [c.effects for c in combinations(wide, ["first", "second"], DRIVEN)]
    assert kept == [(), ("first",), ("second",)]


def test_regimes_are_those_of_the_motion(found):
    regimes = found[()].regimes
    inward, outward = np.sin(TIME) > 1 / 30, np.sin(TIME) < -1 / 30
    off = FIRST + 0.5 * SECOND
    assert regimes["winding in"] == pytest.approx(rms(off[inward]), rel=0.02)
    assert regimes["paying out"] == pytest.approx(rms(off[outward]), rel=0.02)


def test_motors_whose_current_is_commanded_do_not_count():
    assert combinations(tables(), ["first"], set()) == []


def test_those_only_screened_come_last(data):
    _, effects = switchable(data)
    assert effects == ["capstan_friction", "coulomb_friction", "cogging"]


def test_the_named_effect_of_the_run_is_switched_on(data):
    context = Switches().get_context(data)
    on = [switch["name"] for switch in context["switches"] if switch["on"]]
    assert on == [effect["name"] for effect in DIAGNOSIS["effects"]]
    assert len(context["combinations"]) == len(context["rows"]) == 8
    assert sum("in replay" in row["how"] for row in context["rows"]) == 4
