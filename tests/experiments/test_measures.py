"""Measures against signals whose answer is known in closed form."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.experiments import Side, repeating
from spirob.experiments.active_contact import ActiveContact
from spirob.experiments.delay import Delay
from spirob.experiments.extreme_curl import knee
from spirob.experiments.hysteresis import Hysteresis, loop_area
from spirob.experiments.periodic_contact import PeriodicContact, seen
from spirob.experiments.response import (
    amplitude,
    crossing,
    detected,
    each_in_its_own,
    onset,
    rmse,
    step_times,
    strongest_period,
)
from spirob.experiments.single_contact import SingleContact, rank_agreement, responses, visible
from spirob.logs.trace import moving_average
from spirob.perceive.contact import ContactSettings

TIME = np.arange(3000) * 1e-3


def side(current=None, displacement=None, cycles=3000):
    """Both motors alike; zero where nothing is given."""
    flat = np.zeros((cycles, 2))
    two = [flat if v is None else np.column_stack([v, v]) for v in (current, displacement)]
    return Side(two[0], two[1], flat, flat)


@settings(max_examples=25, deadline=None)
@given(st.floats(0.01, 0.3), st.floats(-5, 5).filter(lambda h: abs(h) > 0.1), st.floats(-2, 2))
def test_a_first_order_lag_answers_after_tau_ln_2(tau, height, start):
    answer = start + height * np.where(TIME < 0.5, 0.0, 1 - np.exp(-(TIME - 0.5) / tau))
    found = step_times(answer, 0.5, (2.9, 3.0))
    assert found["delay"] == pytest.approx(tau * np.log(2), abs=2e-3)
    assert found["rise"] == pytest.approx(tau * np.log(9), abs=4e-3)


def test_the_papers_mean_alone_delays_by_49_5_ms():
    step = (TIME >= 0.5).astype(float)
    assert step_times(moving_average(step, 100), 0.5, (1, 2))["delay"] == pytest.approx(
        0.0490, abs=1e-3
    )


def test_a_crossing_that_does_not_last_is_none():
    values = np.zeros(100)
    values[40:43] = 1.0
    assert np.isnan(crossing(values, 0.5))
    values[60:] = 1.0
    assert crossing(values, 0.5) == pytest.approx(0.0595)


@settings(max_examples=25, deadline=None)
@given(st.floats(0, 3.14), st.floats(0.1, 10), st.floats(0.001, 0.1))
def test_the_loop_of_a_lagging_sine_is_an_ellipse(lag, force, stroke):
    phase = np.linspace(0, 2 * np.pi, 5000, endpoint=False)
    area = loop_area(force * np.sin(phase), stroke * np.sin(phase - lag))
    assert area == pytest.approx(np.pi * force * stroke * np.sin(lag), abs=1e-4 * force * stroke)


def test_a_loop_without_lag_has_no_area_and_turns_its_sign_with_its_sense():
    force = np.concatenate([np.linspace(0, 3, 500), np.linspace(3, 0, 500)])
    assert loop_area(force, np.tanh(force)) == pytest.approx(0.0, abs=1e-9)
    late = np.roll(np.tanh(force), 100)
    assert loop_area(force, late) == pytest.approx(-loop_area(force[::-1], late[::-1]))
    assert loop_area(force, late) > 0.1


def test_the_knee_of_a_motion_that_stops():
    velocity = np.where(TIME < 2.0, 0.06, 0.0)
    current = np.where(TIME < 2.1, 0.5, 5.0)
    found = knee(velocity, current)
    assert found["velocity knee"] == pytest.approx(2.0, abs=0.012)
    assert found["current knee"] == pytest.approx(2.1, abs=0.012)
    assert (found["free current"], found["last current"]) == (0.5, 5.0)
    assert "current knee" not in knee(velocity, None)


def test_a_hit_is_the_difference_to_the_trial_without_it():
    drift = 1e-3 * TIME
    push = 2e-3 * np.exp(-np.maximum(TIME - 0.5, 0) / 0.1) * (TIME >= 0.5)
    shift = np.where(TIME >= 0.5, 0.0061, 0.0)
    hit, free = side(0.8 + shift, drift + push), side(np.full(3000, 0.8), drift)
    found = responses(hit, free, 0.5)
    counts = 2e-3 * 8192 / (2 * np.pi * 0.02)
    assert found["angle"] == pytest.approx(counts)
    assert found["shift"] == pytest.approx(0.0061 * 16384 / 20)
    nothing = responses(free, free, 0.5)
    assert nothing["angle"] == nothing["peak"] == nothing["filtered"] == nothing["shift"] == 0.0
    assert found["filtered"] == pytest.approx(found["shift"])  # a step is whole after the mean
    bare = Side(None, hit.displacement, hit.velocity, hit.command)
    assert responses(bare, free, 0.5) == {"angle": found["angle"], "angle error": 0.0}


def test_what_a_drive_cannot_show():
    assert visible(-2.0)
    assert not visible(0.9)
    assert not visible(2.0, error=3.0)


def test_rank_agreement():
    assert rank_agreement([1, 2, 5], [10, 20, 21]) == pytest.approx(1.0)
    assert rank_agreement([1, 2, 5], [3, 2, 1]) == pytest.approx(-1.0)
    assert np.isnan(rank_agreement([0, 0, 0], [1, 2, 3]))


@settings(max_examples=25, deadline=None)
@given(st.floats(0.05, 0.6), st.floats(0.1, 50), st.floats(-1, 1))
def test_the_period_of_a_sine_on_a_slope(period, size, slope):
    values = size * np.sin(2 * np.pi * TIME / period) + slope * TIME
    assert strongest_period(values, 0.02, 1.0) == pytest.approx(period, rel=0.03)
    assert amplitude(values, period) == pytest.approx(size, rel=0.12, abs=0.05)


def test_a_flat_signal_has_no_period():
    assert np.isnan(strongest_period(np.ones(2000), 0.02, 0.8))


def test_ten_hertz_is_a_null_of_the_papers_mean():
    """So a contact every 0.1 s leaves no line there, whatever its size."""
    hit, free = side(0.1 * np.sin(2 * np.pi * 10 * TIME)), side()
    raw, mean = (seen(hit, free, s, 0.5) for s in ("current", "filtered"))
    assert amplitude(raw, 0.1) == pytest.approx(0.1 * 16384 / 20, rel=1e-3)
    assert amplitude(mean, 0.1) < 1e-9 * amplitude(raw, 0.1)


def test_what_no_count_shows_has_neither_period_nor_order():
    """The sensor's noise has a strongest line, and an order of places, that mean nothing."""
    rng = np.random.default_rng(0)
    count = 20 / 16384
    experiment = PeriodicContact()
    names = [p.name for p in experiment.plays()]
    sides = {n: {"robot": side(4 * count * rng.normal(size=4500), cycles=4500)} for n in names}
    rows = {r["what"]: r for r in experiment.measure(sides)}
    assert rows["apparent period of current, at 55%"]["robot"] is None
    assert "not visible" in rows["apparent period of current, at 55%"]["note"]
    hits = SingleContact()
    calm = {
        p.name: {"robot": side(0.2 * count * rng.normal(size=1200), cycles=1200)}
        for p in hits.plays()
    }
    for play in calm.values():
        play["base"] = play["named"] = play["robot"]
    rows = {r["what"]: r for r in hits.measure(calm)}
    told = rows["rank agreement of current peak, 50 Hz"]
    assert (told["robot"], told["named"], told["met"]) == (None, None, None)
    assert "there is no order" in told["note"]


def test_the_baseline_of_the_delay_hears_through_the_same_mean():
    still = Side(None, np.zeros((2500, 2)), np.zeros((2500, 2)), np.zeros((2500, 2)))
    found = Delay().times(still, 2.0)
    assert found["raw"] == 0.0
    assert found["filtered"] == pytest.approx(49.0, abs=1.0)
    assert found["held"] == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("alone", "met"), [(0.0, True), (0.04, True), (0.06, False), (-0.2, False)]
)
def test_a_baseline_without_a_loop_is_told(alone, met):
    experiment = Hysteresis(period=2.0, periods=1.0)
    time = np.arange(2000) * 1e-3
    force = experiment.low + (experiment.high - experiment.low) * (1 - np.abs(time - 1.0))
    late = np.roll(force, 100)
    moved = {"robot": late, "single": force + alone * (late - force)}
    flat = np.zeros((2000, 2))
    sides = {
        s: Side(flat if s == "robot" else None, np.column_stack([x, x]), flat, flat)
        for s, x in moved.items()
    }
    rows = {r["what"]: r for r in experiment.measure({"hysteresis": sides})}
    assert rows["area of the baseline's loop"]["met"] is met
    assert rows["area of the loop"]["met"] is None  # no model played


def test_onset_and_detection_of_a_contact():
    free = np.full(3000, 0.6)
    contact = free + 10 * np.maximum(TIME - 2.0, 0)
    assert onset(contact, free, 500) == pytest.approx(2.003, abs=0.005)
    assert onset(contact[:2030], free, 500) == onset(contact, free, 500)  # up to its recoil
    assert np.isnan(onset(free, free, 500))
    assert np.isnan(onset(free[:2030], free, 500))
    assert 2.0 < detected(contact, 500, 3000, ContactSettings()) < 2.1
    assert np.isnan(detected(free, 500, 3000, ContactSettings()))
    assert np.isnan(detected(contact, 500, 1900, ContactSettings()))
    assert rmse(contact, contact) == 0.0
    assert rmse(free, free + 0.3) == pytest.approx(0.3)


def test_currents_are_compared_in_the_same_motion():
    """To recoil later than the robot did is told beside it, as an error of its own."""
    experiment = ActiveContact(places=(0.5,), again=0)
    time = np.arange(9000) * 1e-3
    free = np.full(9000, 0.6)
    robot = free + 10 * np.maximum(time - 8.0, 0)
    alone = np.where(time < 8.06, robot + 0.02, 9.0)
    sides = {"uncurl_free": {"robot": side(free), "named": side(free + 0.01)}}
    moved = {repeating("named"): side(robot + 0.02)}
    sides["uncurl_50"] = {"robot": side(robot), "named": side(alone), **moved}
    sides |= {name.replace("_", "_filtered_", 1): both for name, both in sides.items()}
    rows = {r["what"]: r for r in experiment.measure(sides)}
    for signal in ("current", "filtered current"):
        free = rows[f"{signal} RMSE against the robot, free"]
        same = rows[f"{signal} RMSE against the robot, contact at 50%"]
        apart = rows[f"{signal} RMSE, each with its own recoil, contact at 50%"]
        assert free["named"] == pytest.approx(0.01, rel=1e-6)
        assert same["named"] == pytest.approx(0.02, rel=1e-6)
        assert same["met"]
        assert same["base"] is None
        assert apart["named"] > 1.0
        assert apart["met"] is False
        assert apart["robot"] is None  # played once, it has nothing to be compared with
    drawn = {c["side"] for c in experiment.curves(sides)}
    assert drawn == {"robot", "named"}


def test_a_robot_that_does_not_repeat_itself_is_compared_with_itself():
    """Two early and two late steps: four of six pairs differ, and two of four from a late model."""
    early, late = (side((TIME - at >= 0).astype(float)) for at in (1.0, 1.3))
    apart = rmse(early.driven("current", 1), late.driven("current", 1))
    assert apart == pytest.approx(np.sqrt(0.1))
    found = each_in_its_own("x", [early, early, late, late], {"named": late}, "current", 1)
    assert found["robot"] == pytest.approx(4 / 6 * apart, rel=1e-5)
    assert found["named"] == pytest.approx(apart / 2, rel=1e-5)
    assert found["met"] is False
    assert "4 plays" in found["note"]
