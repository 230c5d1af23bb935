"""An effect that a motion is too small to show is no candidate, and says why."""

from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from spirob.effects import all_effects
from spirob.identify.intervals import Estimate
from spirob.machine.candidates import related, seldom_seen, with_room
from spirob.machine.laws import for_axis
from spirob.machine.scaling import Sizes, parameters
from spirob.machine.shapes import periods


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


@given(st.floats(1.0, 200.0), st.floats(0.1, 50.0))
def test_the_periods_of_a_wave_are_its_order_times_the_turns(order, turned):
    cogging = all_effects()["cogging"]
    values = {f: p.nominal for f, p in cogging.parameters().items()}
    own = order * turned / 6.283185307179586
    if 1.0 <= own <= 200.0:
        assert periods(cogging, {**values, "order": order}, turned) == pytest.approx(own, abs=0.2)
        fast = {**values, "order": order, "sine": 1e-6, "second_sine": 0.01, "ratio": 2.0}
        assert periods(cogging, fast, turned) == pytest.approx(2 * own, abs=0.2)


@pytest.mark.parametrize(
    ("order", "width", "turns", "seldom"),
    [
        (7.3, 0.1, 0.3, True),  # two periods of a curve
        (7.3, 0.1, 0.5, False),  # it comes again
        (7.0, 0.1, 0.3, False),  # a whole number in a turn
        (7.0, 2.0, 0.3, True),  # or any other
        (0.1, 0.01, 20.0, True),  # none in a turn of the rotor
    ],
)
def test_a_wave_comes_round_three_times_or_is_whole_in_a_turn(order, width, turns, seldom):
    cogging = all_effects()["cogging"]
    about = sizes(turns * 6.283185307179586)
    told = {
        f"cogging.{f}": Estimate(p.nominal, p.low, p.high, p.unit, False)
        for f, p in parameters(cogging, about).items()
    }
    told["cogging.order"] = Estimate(order, order - width / 2, order + width / 2, "1", False)
    model = SimpleNamespace(effects=(cogging,), fit=SimpleNamespace(estimates=told))
    assert seldom_seen(model, about) is seldom
    disc = all_effects()["encoder_eccentricity"]  # comes round once a turn, however little is seen
    assert not seldom_seen(
        SimpleNamespace(
            effects=(disc,),
            fit=SimpleNamespace(
                estimates={
                    f"{disc.name()}.{f}": Estimate(p.nominal, p.low, p.high, p.unit, False)
                    for f, p in parameters(disc, about).items()
                }
            ),
        ),
        about,
    )
