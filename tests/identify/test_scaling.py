"""Coordinates of a fit: there and back, inside their box."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.effects import find_effects
from spirob.identify.scaling import Scaling
from tests.identify.known import spirob

MODEL = ["winch.efficiency", "motor.rotor_damping", "arm.base_stiffness", "arm.damping_time"]
EFFECTS = ["coulomb_friction", "cogging", "capstan_friction"]
AMPLITUDES = ["coulomb_friction.coulomb_torque", "cogging.sine", "capstan_friction.friction"]
SETS = [MODEL, MODEL[1:], [*MODEL, *AMPLITUDES, "cogging.sine_difference"]]
SHARES = st.lists(st.floats(0.0, 1.0), min_size=8, max_size=8)


@pytest.fixture(scope="module")
def table():
    return spirob(find_effects(EFFECTS)).table


@pytest.mark.parametrize("names", SETS)
@settings(max_examples=60, deadline=None)
@given(shares=SHARES)
def test_there_and_back(table, names, shares):
    scaling = Scaling(table, names)
    values = {}
    for name, share in zip(names, shares, strict=False):
        about = table.about[name]
        low, high = about.reach(about.nominal)
        values[name] = low + share * (high - low)
    u = scaling.scaled(values)
    assert np.all(u >= scaling.low - 1e-9)
    assert np.all(u <= scaling.high + 1e-9)
    for name, value in scaling.physical(u).items():
        assert value == pytest.approx(values[name], rel=1e-9, abs=1e-15)


def test_an_absent_effect_stays_absent_when_the_efficiency_moves(table):
    scaling = Scaling(table, [*MODEL, *AMPLITUDES])
    values = dict(zip(table.names, table.values, strict=True))
    u = scaling.scaled({n: values[n] for n in scaling.names})
    u[0] *= 0.9
    moved = scaling.physical(u)
    assert moved["winch.efficiency"] == pytest.approx(values["winch.efficiency"] / 0.9)
    for name in AMPLITUDES:
        assert moved[name] == 0.0


def test_an_interval_covers_both_ends_of_its_coordinates(table):
    """Only the efficiency uncertain: the load that is known relative to it moves along."""
    scaling = Scaling(table, MODEL)
    values = dict(zip(table.names, table.values, strict=True))
    u = scaling.scaled({n: values[n] for n in MODEL})
    covariance = np.zeros((4, 4))
    covariance[0, 0] = 0.01**2
    low, high = scaling.spread(u, covariance)
    relative = (high - low) / np.array([values[n] for n in MODEL])
    assert relative[:3] == pytest.approx(2 * 1.96 * 0.01, rel=0.01)
    assert relative[3] == pytest.approx(0.0, abs=1e-6)
