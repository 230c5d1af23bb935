"""The poles of the host's loop are those of law and winding, stepped, and sit where they should."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.control import (
    CYCLE,
    HostLoop,
    Winding,
    fastest,
    for_bandwidth,
    host_voltage,
    largest,
    latest,
    placed,
    poles,
    stable,
)
from spirob.errors import ConfigError
from spirob.plant import Rig
from spirob.plant.motor import held_current

R, L = 0.194, 9.7e-5
WINDING = Winding(R, L)
LATENCY = st.floats(0.0, 1.99e-3)
FREE = 1e9


def stepped(state, latency, gains):
    """A cycle of law and winding at i_cmd = 0; state: i, integral, error, two voltages before."""
    current, integral, error, before, earlier = state
    voltage, integral, error = host_voltage(
        0.0, 0.0, current, error, 0.0, integral, CYCLE, R, L, 0.02, *gains, FREE
    )
    whole = int(latency / CYCLE)
    acting = [voltage, before, earlier]
    late = latency - whole * CYCLE
    current, _ = held_current(
        current, acting[whole + 1], acting[whole], late, CYCLE, 0.0, 0.0, R, L, FREE
    )
    return np.array([current, integral, error, voltage, before])


@settings(max_examples=80, deadline=None)
@given(LATENCY, st.floats(0.001, 0.3), st.floats(0.1, 200.0), st.floats(1e-7, 1e-4))
def test_poles_are_those_of_the_stepped_loop(latency, proportional, integral, derivative):
    gains = (proportional, integral, derivative)
    matrix = np.array([stepped(unit, latency, gains) for unit in np.eye(5)]).T
    exact = np.poly(matrix)  # of degree 5; what the latency does not need are roots at zero
    found = np.poly(poles(WINDING, latency, gains)).real
    found = np.append(found, np.zeros(6 - len(found)))
    assert found == pytest.approx(exact, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("latency", [0.0, 0.4e-3, 1e-3, 1.7e-3])
@pytest.mark.parametrize("bandwidth", [5.0, 20.0, 60.0])
def test_both_poles_of_the_error_equation_are_where_they_were_placed(latency, bandwidth):
    gains = for_bandwidth(WINDING, latency, bandwidth)
    found = poles(WINDING, latency, gains)
    slow = np.exp(-2 * np.pi * bandwidth * CYCLE)
    for wanted in (slow, np.exp(-CYCLE * R / L)):
        assert np.abs(found - wanted).min() < 1e-7
    assert np.abs(found).max() == pytest.approx(slow, rel=1e-7)  # no other pole is slower
    assert stable(WINDING, latency, gains)


def test_at_a_fast_rate_the_gains_are_those_of_the_continuous_equation():
    # T R/L → 0 with a winding as slow, and no latency: K_p → 2πf L, K_i → 2πf R
    slow = Winding(1e-3, 1.0)
    proportional, integral, _ = for_bandwidth(slow, 0.0, 0.1)
    omega = 2 * np.pi * 0.1
    assert proportional == pytest.approx(omega * 1.0, rel=1e-3)
    assert integral == pytest.approx(omega * 1e-3, rel=1e-3)


@settings(max_examples=30, deadline=None)
@given(LATENCY)
def test_a_bandwidth_beyond_the_latency_is_refused_with_the_largest(latency):
    most = fastest(WINDING, latency)
    for_bandwidth(WINDING, latency, 0.999 * most)
    with pytest.raises(ConfigError, match=rf"the largest bandwidth is {most:.1f} Hz"):
        for_bandwidth(WINDING, latency, 1.01 * most)


def test_a_cycle_of_latency_allows_110_hertz():
    # z(z - 1) + κ = 0 has a double root at 1/2
    assert fastest(WINDING, CYCLE) == pytest.approx(np.log(2) / (2 * np.pi * CYCLE), rel=1e-3)


@settings(max_examples=30, deadline=None)
@given(LATENCY, st.floats(0.0, 0.2), st.floats(1.0, 100.0), st.floats(0.0, 2e-5))
def test_margins_are_the_edge(latency, proportional, integral, derivative):
    gains = (proportional, integral, derivative)
    times = largest(WINDING, latency, gains)
    within, beyond = (tuple(f * times * g for g in gains) for f in (0.9999, 1.0001))
    assert stable(WINDING, latency, within)
    assert not stable(WINDING, latency, beyond)
    edge = latest(WINDING, gains)
    if 0.0 < edge < 9e-3:
        assert stable(WINDING, edge - 1e-8, gains)
        assert not stable(WINDING, edge + 1e-8, gains)


def test_unstable_gains_are_refused_with_the_largest_that_are_stable():
    with pytest.raises(ConfigError, match="is unstable with K_p = 2 V/A") as refused:
        placed(HostLoop(proportional=2.0, integral=100.0), R, L)
    said = str(refused.value).split("that are stable: ")[1].replace(",", "").split()
    largest_p, largest_i = float(said[2]), float(said[5])
    placed(HostLoop(proportional=0.99 * largest_p, integral=0.99 * largest_i), R, L)
    with pytest.raises(ConfigError):
        placed(HostLoop(proportional=1.01 * largest_p, integral=1.01 * largest_i), R, L)


def test_a_rig_says_where_its_current_loop_is_closed():
    assert Rig.from_mapping({"drive": {"loop": "drive"}}) == Rig()
    rig = Rig.from_mapping({"drive": {"loop": "host", "host": {"bandwidth": 20.0}}})
    assert rig.host == HostLoop(bandwidth=20.0)
    for drive, words in (
        ({"loop": "bus"}, "drive.loop is drive or host, not 'bus'"),
        ({"loop": "host", "host": {"speed": 1.0}}, "host has no number 'speed'"),
        ({"loop": "host", "host": 3}, "drive.host must be a mapping"),
        ({"loop": "host", "host": {"bandwidth": 200.0}}, "largest bandwidth is 110.3 Hz"),
    ):
        with pytest.raises(ConfigError, match=words):
            Rig.from_mapping({"drive": drive})
