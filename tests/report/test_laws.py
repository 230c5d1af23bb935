"""A law over its data: what is shown without it, how much it accounts for, and its rivals."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from spirob.effects import all_effects
from spirob.report.sections.laws import (
    LOAD,
    PLACE,
    SPEED,
    TIME,
    Law,
    Laws,
    against,
    law,
    medians,
    rivals,
    sentence,
)

TIME_S = np.arange(0, 4, 0.01)
FRICTION = 0.2 * np.sign(np.sin(TIME_S))


def tables(strength):
    """A robot with friction, and a model whose friction is `strength` times that."""
    about = {"trial": "a", "motor": "left", "time": TIME_S}
    speed = np.sin(TIME_S)
    measured = {
        "measured_current": 1.0 + FRICTION,
        "measured_velocity": speed,
        "measured_displacement": 1.0 - np.cos(TIME_S),
    }
    sides = {"with_current": 1.0 + strength * FRICTION, "without_current": 1.0}
    return pd.DataFrame(about | sides), pd.DataFrame(about | measured)


def found(strength, driven=(("a", "left"),)):
    return law(*tables(strength), set(driven), all_effects()["coulomb_friction"])


def test_what_is_shown_is_what_the_model_without_the_effect_misses():
    one = found(1.0)
    np.testing.assert_allclose(one.shown, FRICTION, atol=1e-12)
    np.testing.assert_allclose(one.law, FRICTION, atol=1e-12)
    assert one.accounted == pytest.approx(1.0)


@pytest.mark.parametrize(("strength", "accounted"), [(0.5, 0.75), (2.0, 0.0), (-1.0, -3.0)])
def test_a_law_of_the_wrong_size_accounts_for_less(strength, accounted):
    assert found(strength).accounted == pytest.approx(accounted)


def test_motors_that_were_not_driven_show_nothing():
    assert found(1.0, driven=()) is None


@pytest.mark.parametrize(
    ("effect", "signal"),
    [
        ("coulomb_friction", SPEED),
        ("capstan_friction", SPEED),
        ("cogging", PLACE),
        ("drum_build_up", PLACE),
        ("torque_constant_saturation", LOAD),
        ("current_gain", LOAD),
        ("current_lag", LOAD),
        ("tip_payload", TIME),
    ],
)
def test_a_law_is_drawn_over_what_it_depends_on(effect, signal):
    assert against(all_effects()[effect]) is signal


def test_a_law_of_a_users_own_effect_is_drawn_over_time():
    assert against(None) is TIME


def test_medians_follow_a_curve_through_noise():
    rng = np.random.default_rng(0)
    x = rng.uniform(-1, 1, 4000)
    middle, median = medians(x, x**3 + 0.3 * rng.standard_normal(4000))
    assert np.abs(median - middle**3).max() < 0.12


def test_the_sentence_says_so_when_a_law_takes_nothing_off():
    worse = Law(SPEED, TIME_S, FRICTION, -FRICTION)
    assert "takes nothing off" in sentence(worse)
    assert "accounts for 75 %" in sentence(replace(worse, law=0.5 * FRICTION))


def test_every_rival_has_what_it_leaves_and_an_experiment(data):
    others = rivals("capstan_friction", data)
    """But who was only screened leaves nothing that is known."""
    titles = [c["title"] for c in data.diagnosis["candidates"][1:-1]]
    assert [one["title"] for one in others] == titles
    assert all(one["left"].endswith(" mA") and one["test"] for one in others)
    known = all_effects()["capstan_friction"].tell_apart
    by_title = {one["title"]: one["test"] for one in others}
    assert by_title["Coulomb friction"] == known["coulomb_friction"]


def test_the_section_draws_two_figures_for_the_named_effect(data):
    (one,) = Laws().get_context(data)["effects"]
    assert [plot.name for plot in one["plots"]] == [
        "law-capstan_friction",
        "law-capstan_friction-itself",
    ]
