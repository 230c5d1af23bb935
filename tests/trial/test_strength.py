"""Strengths are drawn for every kind, and so that the oracle's gain is as asked."""

import numpy as np
import pytest

from spirob.emulator import hidden
from spirob.errors import ConfigError
from spirob.trial.case import Case, _drawn
from spirob.trial.strength import (
    FACTOR,
    LARGEST,
    LEFT,
    RATIOS,
    VISIBLE,
    adjusted,
    drawn_size,
    strength_of,
)


def test_every_kind_that_these_logs_can_show_has_a_visibility():
    silent = {"none", "current_gain", "rest_curvature", "stiffness_hardening"}
    assert set(VISIBLE) == set(hidden.effects()) - silent
    assert len(VISIBLE) >= 18


def test_the_error_without_the_effect_stands_in_the_asked_ratio():
    rng = np.random.default_rng(3)
    ratios = [LEFT / np.hypot(LEFT, drawn_size(rng)) for _ in range(500)]
    assert RATIOS[0] < min(ratios) < max(ratios) < RATIOS[1]
    assert max(ratios) - min(ratios) > 0.9 * (RATIOS[1] - RATIOS[0])


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
    assert adjusted(0.5, 0.35, 0.7) == pytest.approx(1.0)
    assert adjusted(0.5, 0.0, 0.7) == pytest.approx(0.5 * FACTOR)
    assert adjusted(0.5, 70.0, 0.7) == pytest.approx(0.5 / FACTOR)
    assert adjusted(2.0, 0.1, 0.7) == LARGEST


def test_a_robot_that_shows_too_little_is_recorded_again(monkeypatch):
    played = []
    names = _drawn.__globals__
    monkeypatch.setitem(names, "recorded", lambda hidden, seed: played.append(hidden) or hidden)
    shares = iter([0.3, 0.7])
    monkeypatch.setitem(names, "left", lambda trials: next(shares))
    hidden, trials = _drawn(Case("cogging", 5))
    assert len(played) == 2
    assert trials is hidden is played[1]
    assert played[1].parts[0][1] > 2 * played[0].parts[0][1]
    monkeypatch.setitem(names, "left", lambda trials: 0.7)
    _drawn(Case("cogging", 5))
    assert len(played) == 3
