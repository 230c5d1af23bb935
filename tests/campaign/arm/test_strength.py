"""Strengths are drawn for every kind, and so that the oracle's gain is as asked."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from spirob.campaign.arm.strength import (
    FACTOR,
    LARGEST,
    LEFT,
    NEAR,
    RATIOS,
    TRIES,
    VISIBLE,
    adjusted,
    drawn,
    drawn_size,
    nothing,
    sizes,
    strength_of,
)
from spirob.diagnosis.criteria import Settings
from spirob.emulator import hidden
from spirob.errors import ConfigError
from spirob.identify.problem import FITTED

SHOWN = NEAR[0] * sizes()[0], NEAR[1] * sizes()[1]


def test_every_kind_that_these_logs_can_show_has_a_visibility():
    silent = {"none", "current_gain", "rest_curvature", "stiffness_hardening"}
    assert set(VISIBLE) == set(hidden.effects()) - silent
    assert len(VISIBLE) >= 18


@pytest.mark.parametrize("asked", [RATIOS, (0.35, 0.9)])
@pytest.mark.parametrize("left", [LEFT, 0.8])
def test_the_error_without_the_effect_stands_in_the_asked_ratio(asked, left):
    rng = np.random.default_rng(3)
    ratios = [left / np.hypot(left, drawn_size(rng, asked, left)) for _ in range(500)]
    assert asked[0] < min(ratios) < max(ratios) < asked[1]
    assert max(ratios) - min(ratios) > 0.9 * (asked[1] - asked[0])


@pytest.mark.parametrize("kind", sorted(VISIBLE))
def test_a_strength_shows_what_was_drawn(kind):
    strength = strength_of(kind, 0.7)
    assert strength == LARGEST or strength * VISIBLE[kind] == pytest.approx(0.7)


def test_a_kind_that_no_log_can_show_is_a_sentence():
    with pytest.raises(ConfigError, match="no kind 'current_gain'"):
        strength_of("current_gain", 0.7)


def test_nothing_hidden_has_strength_one():
    assert strength_of("none", 0.7) == 1.0


def test_an_adjustment_goes_where_a_linear_kind_shows_what_is_wanted():
    assert adjusted([(0.5, 0.35)], 0.7) == pytest.approx(1.0)
    assert adjusted([(0.5, 0.0)], 0.7) == pytest.approx(0.5 * FACTOR)
    assert adjusted([(0.5, 70.0)], 0.7) == pytest.approx(0.5 / FACTOR)
    assert adjusted([(2.0, 0.1)], 0.7) == LARGEST


@pytest.mark.parametrize("power", [0.7, 1.0, 1.7, 2.5])
def test_two_tries_tell_how_what_is_left_grows(power):
    tries = [(s, 3.0 * s**power) for s in (0.5, 0.2)]
    assert 3.0 * adjusted(tries, 0.7) ** power == pytest.approx(0.7)


def test_a_try_that_shows_nothing_tells_no_power():
    assert adjusted([(0.5, 0.0), (0.125, 0.0)], 0.7) == pytest.approx(0.125 * FACTOR)


@pytest.mark.parametrize("edge", [0.13, 0.2, 0.31, 0.45])
@pytest.mark.parametrize("steep", [4.0, 8.0])
def test_a_kind_that_sets_in_all_at_once_is_met_within_the_tries(edge, steep):
    """It shows what is wanted at `edge`, nearly nothing below, and far too much above."""

    def shown(strength):
        return 0.7 * (strength / edge) ** steep

    tries = [(0.155, shown(0.155))]
    while not SHOWN[0] < tries[-1][1] < SHOWN[1] and len(tries) < TRIES:
        tries.append((adjusted(tries, 0.7), shown(adjusted(tries, 0.7))))
    nearest = min(abs(math.log(s / 0.7)) for _, s in tries)
    assert nearest <= math.log(2.0)


@pytest.fixture
def names(monkeypatch):
    """What a draw calls, without robots; "played" holds what was hidden in each."""
    played = []
    names = drawn.__globals__
    monkeypatch.setitem(names, "recorded", lambda hidden, seed: played.append(hidden) or hidden)
    monkeypatch.setitem(names, "problems_of", lambda trials, plant: trials)
    monkeypatch.setitem(names, "_without_any", lambda *_: SimpleNamespace(fit=None))
    monkeypatch.setitem(names, "played", played)
    return names


def test_each_of_two_is_as_strong_as_it_would_be_alone(monkeypatch, names):
    shares = iter([2.7, 0.74, 0.31, 0.74, 9.9])
    monkeypatch.setitem(names, "left", lambda base, problems: next(shares))
    hidden, problems, _ = drawn("cogging+joint_creep", 5, 41, None, Settings(), build="as_designed")
    *_, cogging, weak, creep, both = names["played"]
    assert problems is hidden is both
    assert both.parts == [*cogging.parts, *creep.parts]
    assert creep.parts[0][1] > weak.parts[0][1]


def test_a_robot_is_recorded_until_it_shows_what_is_wanted(monkeypatch, names):
    played = names["played"]
    shares = iter([2.7, 0.31, 0.74])
    monkeypatch.setitem(names, "left", lambda base, problems: next(shares))
    hidden, problems, _ = drawn("cogging", 5, 41, None, Settings(), build="as_designed")
    first, second, third = (h.parts[0][1] for h in played)
    assert problems is hidden is played[2]
    assert second < third < first
    shares = iter([3.0, 0.42, 5.0, 0.3, 6.0])
    hidden, problems, _ = drawn("cogging", 5, 41, None, Settings(), build="as_designed")
    assert problems is hidden is played[4], "the nearest of all tries"
    monkeypatch.setitem(names, "left", lambda base, problems: 0.01)
    drawn("cogging", 5, 41, None, Settings(), build="as_designed")
    assert len(played) == 3 + TRIES + 4, "the strongest that is drawn is played once"
    assert played[-1].parts[0][1] == LARGEST
    drawn("none", 5, 41, None, Settings(), build="as_designed")
    assert len(played) == 3 + TRIES + 5


def test_what_a_robot_leaves_with_nothing_hidden_is_its_own_fit_s(monkeypatch, names):
    monkeypatch.setitem(names, "problems_of", lambda trials, plant: {"train": trials})
    monkeypatch.setitem(names, "begun", lambda train, *of: SimpleNamespace(fit=(train, *of)))
    monkeypatch.setitem(names, "left", lambda base, problems: (base, problems["train"]))
    (fitted, numbers, start, _), trials = nothing(41, "rough")
    assert [trials] == names["played"]
    assert fitted is trials
    assert (trials.effect, trials.build) == ("none", "rough")
    assert (numbers, start) == (FITTED, {})


def test_every_robot_of_a_case_is_built_as_asked(monkeypatch, names):
    """And its effects count beside what that robot leaves with nothing hidden."""
    floors = []
    monkeypatch.setitem(names, "nothing", lambda *of: floors.append(of) or 0.4)
    monkeypatch.setitem(names, "left", lambda base, problems: 0.4 / 0.32)
    drawn("cogging+joint_creep", 5, 41, None, Settings(), build="rough")
    assert len(names["played"]) == 3
    assert {hidden.build for hidden in names["played"]} == {"rough"}
    assert floors == [(41, "rough")] * 2
