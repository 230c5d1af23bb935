"""An effect that a motion is too small to show is no candidate, and says why."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spirob.effects import all_effects
from spirob.identify.intervals import Estimate
from spirob.machine.inverse.scaling import Sizes, parameters
from spirob.machine.inverse.shapes import repeated_waves, seldom_seen, turned_round
from spirob.machine.laws import for_axis, related
from spirob.machine.search.preparation import with_room


def sizes(stroke, gear=1.0):
    return Sizes(0.02, 50.0, 1.0 / gear, stroke, 1.0, 0.1, "N·m", "A", "rad")


@pytest.mark.parametrize("gear", [0.02, 1.0, 101.0, 1500.0])
@pytest.mark.parametrize("stroke", [1e-6, 0.01, 1.0, 100.0])
def test_every_number_of_a_candidate_has_room(stroke, gear):
    library = list(all_effects().values())
    possible, excluded = with_room(library, sizes(stroke, gear))
    assert {e.name() for e in possible} | set(excluded) == set(all_effects())
    for effect in possible:
        assert all(p.low < p.high for p in parameters(effect, sizes(stroke, gear)).values())


def test_a_wave_that_never_comes_round_is_excluded_with_its_reason():
    cogging = [all_effects()["cogging"]]
    assert with_room(cogging, sizes(100.0)) == (cogging, {})
    possible, excluded = with_room(cogging, sizes(0.01))
    assert possible == []
    assert excluded["cogging"].startswith("the motion is too small to show it")
    assert "'order'" in excluded["cogging"]


def test_a_gear_loses_by_its_load_in_one_way_and_other_laws_stand_beside():
    laws = {e.name(): e for e in for_axis(all_effects().values())}
    friction, efficiency = (
        laws[n] for n in ("load_dependent_friction", "direction_dependent_efficiency")
    )
    assert related(friction, [efficiency])
    assert related(efficiency, [friction])
    others = [e for n, e in laws.items() if e not in (friction, efficiency)]
    assert not related(friction, others)
    assert not related(efficiency, others)


@pytest.mark.parametrize(
    ("order", "at_bound", "seldom"),
    [(2.0, True, True), (2.0, False, False), (100.0, True, False), (7.0, False, False)],
)
def test_a_wave_that_would_be_longer_still_is_a_curve(order, at_bound, seldom):
    cogging, about = all_effects()["cogging"], sizes(2 * math.pi)
    told = {
        f"cogging.{f}": Estimate(p.nominal, p.low, p.high, p.unit, False)
        for f, p in parameters(cogging, about).items()
    }
    told["cogging.order"] = Estimate(order, max(order - 1, 2.0), order + 1, "1", at_bound)
    if order == 100.0:
        told["cogging.order"] = Estimate(order, 99.0, 100.0, "1", at_bound)
    model = SimpleNamespace(effects=(cogging,), fit=SimpleNamespace(estimates=told))
    assert seldom_seen(model) is seldom


def test_a_disc_comes_round_once_a_turn_however_little_is_seen():
    disc, about = all_effects()["encoder_eccentricity"], sizes(1.0)
    told = {
        f"{disc.name()}.{f}": Estimate(p.low, p.low, p.high, p.unit, True)
        for f, p in parameters(disc, about).items()
    }
    model = SimpleNamespace(effects=(disc,), fit=SimpleNamespace(estimates=told))
    assert not seldom_seen(model)


@pytest.mark.parametrize(
    ("ratio", "third", "repeated"),
    [
        (2.0, 3.0, []),
        (1.1, 3.0, ["second_sine", "second_cosine", "ratio"]),
        (4.0, 4.1, ["third_sine", "third_cosine", "third_ratio"]),
        (4.0, 3.7, []),
        (
            1.05,
            1.1,
            ["second_sine", "second_cosine", "ratio", "third_sine", "third_cosine", "third_ratio"],
        ),
    ],
)
def test_two_waves_of_one_order_as_the_stroke_tells_it_are_one(ratio, third, repeated):
    cogging, about = all_effects()["cogging"], sizes(2 * math.pi)  # orders are told apart by one
    changes = {f"cogging.{f}": p.nominal for f, p in parameters(cogging, about).items()}
    changes |= {"cogging.order": 5.0, "cogging.ratio": ratio, "cogging.third_ratio": third}
    fit = SimpleNamespace(changes=changes, estimates=dict.fromkeys(changes))
    found = repeated_waves((cogging,), fit, about)
    assert found == [f"cogging.{f}" for f in repeated]


def test_a_wave_that_is_left_out_is_not_repeated():
    cogging, about = all_effects()["cogging"], sizes(2 * math.pi)
    changes = {f"cogging.{f}": p.nominal for f, p in parameters(cogging, about).items()}
    changes |= {"cogging.order": 5.0, "cogging.ratio": 1.0}
    told = {n: None for n in changes if "second" not in n and n != "cogging.ratio"}
    fit = SimpleNamespace(changes=changes, estimates=told)
    assert repeated_waves((cogging,), fit, about) == []


@pytest.mark.parametrize("seconds", [0.5, 9.0, 600.0])
@pytest.mark.parametrize("effort", [0.01, 1.0, 300.0])
def test_how_much_a_motor_warms_is_bounded_by_the_length_of_its_trials(seconds, effort):
    """Of one effort all along the warmth reaches ρ·i²·T(1 - exp(-t/T)), 9 at most."""
    about = replace(sizes(1.0), current=effort, seconds=seconds)
    told = parameters(all_effects()["winding_heating"], about)
    heating, time = told["heating"], told["time"]
    assert heating.high * effort**2 * seconds == pytest.approx(9.0)
    assert heating.low == 0.0 < heating.nominal < heating.high
    assert time.low <= 0.1 * seconds
    assert time.low <= time.nominal <= time.high


@pytest.mark.parametrize(
    ("shares", "at_bound", "turned"),
    [
        ((0.03, 0.0, 0.02, 0.01), False, False),
        ((0.5, 0.0, 0.0, -0.4), False, False),
        ((0.5, 0.0, 0.0, -0.6), False, True),
        ((0.0, 0.0, -0.995, 0.0), True, True),
    ],
)
def test_a_ripple_that_turns_the_torque_round_is_none(shares, at_bound, turned):
    ripple, cogging = all_effects()["torque_ripple"], all_effects()["cogging"]
    told = {
        f"{effect.name()}.{f}": Estimate(value, value - 0.1, value + 0.1, "1", at_bound)
        for effect, size in ((ripple, 1.0), (cogging, 3.0))
        for f, value in zip(effect.neutral, np.multiply(size, shares), strict=False)
    }
    fit = SimpleNamespace(estimates=told)
    assert turned_round(SimpleNamespace(effects=(ripple,), fit=fit)) is turned
    assert not turned_round(SimpleNamespace(effects=(cogging,), fit=fit))
