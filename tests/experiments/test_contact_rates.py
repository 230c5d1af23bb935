"""Rates of contacts that are known, since they are made up."""

import numpy as np
import pytest

from spirob.experiments import Side
from spirob.experiments.contact_rates import (
    MOTIONS,
    SCALES,
    Outcome,
    outcomes,
    rates,
    roc,
    scaled,
    tuned,
    uncurlings,
)
from spirob.perceive.contact import ContactSettings, levels
from spirob.trials import Trial

SAMPLES = 4000
TIME = np.arange(SAMPLES) * 1e-3


def outcome(begins, steepness=10.0, bump=0.0, place=0.5, gap=0.01, motion=2):
    """0.6 A, then a line of that many A/s from `begins` on; a bump of the load at 1 s."""
    rise = 0.0 if np.isnan(begins) else steepness * np.maximum(TIME - begins, 0)
    current = 0.6 + rise + bump * ((TIME > 1.0) & (TIME < 1.5))
    return Outcome(levels(current, ContactSettings()), begins, *MOTIONS[motion], place, gap)


def test_every_contact_is_told_and_none_invented():
    told = rates([outcome(2.0), outcome(3.0), outcome(np.nan)], ContactSettings())
    assert (told["contacts"], told["ever"], told["alarms"]) == (2, 1.0, 0.0)
    # 10 A/s passes half of 0.6 A after 30 ms, seen by a mean of 10 ms, held for 5
    assert told["delay"][0] == pytest.approx(40, abs=6)
    assert told["hits"] == {"10": 1.0, "20": 1.0, "40": 1.0}
    # what comes before a contact is free motion too
    assert told["minutes"] == pytest.approx((2 + 3 + 4) / 60)


def test_a_bump_of_the_load_is_a_false_alarm_and_then_no_hit():
    told = rates([outcome(3.0, bump=0.5)], ContactSettings())
    assert told["ever"] == 0.0
    assert told["delay"] is None
    assert told["alarms"] == pytest.approx(60.0, rel=0.05)  # one in the first second


def test_higher_thresholds_tell_less_of_both():
    found = [outcome(2.0, 5.0), outcome(3.0, 20.0), outcome(np.nan, bump=0.35)]
    points = roc(found)
    assert [p["scale"] for p in points] == list(SCALES)
    hits, alarms = ([p[k] for p in points] for k in ("hits", "alarms"))
    assert alarms == sorted(alarms, reverse=True)
    assert alarms[0] > 0.0 == alarms[-1]
    assert hits[-1] <= max(hits)
    best = tuned(found)
    assert rates(found, scaled(best))["alarms"] == 0.0
    assert all(p["alarms"] > 0 for p in points if p["scale"] < best)


def test_tuning_falls_back_to_the_paper_where_nothing_is_calm():
    assert tuned([outcome(np.nan, bump=40.0)]) == 1.0


def test_trials_are_drawn_alike_and_can_be_played():
    drawn = uncurlings(2, seed=3)
    assert len(drawn) == 4 * len(MOTIONS)
    assert [t.place for t in drawn] == [t.place for t in uncurlings(2, seed=3)]
    assert sum(t.place is None for t in drawn) == 2 * len(MOTIONS)
    for free, peg in zip(drawn[::2], drawn[1::2], strict=True):
        assert (free.place, free.number) == (None, peg.number)
        assert free.play.trial["name"] == peg.play.trial["name"]
        assert "scene" in peg.play.trial
        assert free.play.name != peg.play.name
    assert len({t.number for t in drawn}) == len(drawn) / 2
    for trial in drawn:
        played = Trial.from_plain(trial.play.trial)
        # the same scene but for the peg's place: out of the arm's reach, which is below 1 m
        assert (played.scene.cylinder.y < -1.0) == (trial.place is None)
        first, last = trial.about.window()
        assert 0 < first < last < played.cycles


def test_an_onset_counts_from_the_start_of_the_watch():
    drawn = uncurlings(1, seed=0)[:2]
    first, last = drawn[1].about.window()
    flat = np.zeros((last + 500, 2))
    free, contact = flat + 0.6, flat + 0.6
    contact[first + 1000 :] += 1.0
    sides = [Side(current, flat, flat, flat) for current in (free, contact)]
    alone, met = outcomes(drawn, sides, "current")
    assert np.isnan(alone.begins)
    assert [(o.speed, o.load) for o in (alone, met)] == [MOTIONS[0]] * 2
    assert (alone.place, met.place, met.gap) == (None, drawn[1].place, drawn[1].about.gap)
    assert met.begins == pytest.approx(1.0, abs=0.02)
    assert rates([met], ContactSettings())["ever"] == 1.0
