"""Profiles stay within their bounds, start from zero and know their own derivative."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.errors import ConfigError
from spirob.trials import PROFILES
from spirob.trials.trial import profile_from

T = np.arange(0, 3.0, 1e-4)
LEVEL = st.floats(-2.0, 2.0)
PERIOD = st.floats(0.3, 2.0)
KINDS = {
    "constant": st.fixed_dictionaries({"value": LEVEL}),
    "ramp": st.fixed_dictionaries(
        {"start": LEVEL, "end": LEVEL, "begins": st.floats(0, 1), "ends": st.floats(1.1, 2)}
    ),
    "steps": st.fixed_dictionaries(
        {"plateaus": st.lists(st.tuples(st.floats(0.1, 1), LEVEL).map(list), min_size=1)}
    ),
    "triangle": st.fixed_dictionaries({"low": LEVEL, "high": LEVEL, "period": PERIOD}),
    "sine": st.fixed_dictionaries(
        {"amplitude": st.floats(0, 2), "frequency": st.floats(0.1, 5), "phase": LEVEL}
    ),
    "multisine": st.fixed_dictionaries(
        {
            "amplitude": st.floats(0, 2),
            "low": st.floats(0.1, 1),
            "high": st.floats(2, 10),
            "seed": st.integers(0, 99),
        }
    ),
    "moves": st.fixed_dictionaries(
        {"waypoints": st.lists(st.tuples(st.floats(0.1, 1), LEVEL).map(list), min_size=1)}
    ),
    "shuttle": st.fixed_dictionaries(
        {
            "speeds": st.lists(st.floats(0.05, 0.3), min_size=1, max_size=3),
            "stroke": st.floats(0.05, 0.1),
        }
    ),
}


def highest(kind, given):
    """The largest magnitude that the profile may reach."""
    if kind == "steps":
        return max(abs(value) for _, value in given["plateaus"])
    if kind == "moves":
        return max(abs(target) for _, target in given["waypoints"])
    if kind == "shuttle":
        return max(given["speeds"])
    return max(
        abs(given[k])
        for k in ("value", "start", "end", "low", "high", "amplitude")
        if k in given and not (kind == "multisine" and k in ("low", "high"))
    )


def test_every_profile_is_tested():
    assert set(KINDS) == set(PROFILES)


@pytest.mark.parametrize("kind", sorted(KINDS))
@settings(max_examples=20, deadline=None)
@given(data=st.data())
def test_bounds_start_and_rate(kind, data):
    plain = data.draw(KINDS[kind])
    value, rate = profile_from({"kind": kind, **plain}, "velocity", "here")(T)
    assert np.abs(value).max() <= highest(kind, plain) + 1e-9
    assert abs(value[0]) < 1e-12
    numeric = (value[2:] - value[:-2]) / (T[2] - T[0])
    np.testing.assert_allclose(rate[1:-1], numeric, atol=2e-3 * max(1.0, np.abs(rate).max()))
    np.testing.assert_array_equal(
        value[:1000], profile_from({"kind": kind, **plain}, "velocity", "here")(T[:1000])[0]
    )


@pytest.mark.parametrize("kind", sorted(KINDS))
@settings(max_examples=10, deadline=None)
@given(data=st.data())
def test_no_jump_between_cycles(kind, data):
    plain = data.draw(KINDS[kind])
    value, _ = profile_from({"kind": kind, **plain}, "velocity", "here")(np.arange(0, 3, 1e-3))
    assert np.abs(np.diff(value)).max() < 0.35  # 2·(4 + 1)/50 for the steepest steps, plus slope


def test_a_shuttle_comes_back_to_where_it_started():
    plain = {"kind": "shuttle", "speeds": [0.05, 0.1], "stroke": 0.02, "dwell": 0.1}
    value, _ = profile_from(plain, "velocity", "here")(np.arange(0, 1.59, 1e-4))
    travelled = np.cumsum(value) * 1e-4
    assert travelled.max() == pytest.approx(0.02, rel=1e-4)
    assert abs(travelled[-1]) < 1e-6
    assert value.max() == pytest.approx(0.1)


def test_the_seed_decides_the_multisine():
    plain = {"kind": "multisine", "amplitude": 1.0, "low": 0.5, "high": 8.0}
    one, again, other = (
        profile_from(plain | {"seed": seed}, "force", "here")(T)[0] for seed in (1, 1, 2)
    )
    assert np.array_equal(one, again)
    assert not np.allclose(one, other)
    assert np.abs(one).max() > 0.8


def test_a_multisine_has_no_power_outside_its_band():
    plain = {"kind": "multisine", "amplitude": 1.0, "low": 2.0, "high": 4.0, "blend": 0.0}
    value, _ = profile_from(plain, "current", "here")(np.arange(10_000) * 1e-3)
    spectrum = np.abs(np.fft.rfft(value))
    outside = (np.arange(len(spectrum)) < 20) | (np.arange(len(spectrum)) > 40)
    assert spectrum[outside].max() < 1e-6 * spectrum.max()


@pytest.mark.parametrize(
    ("plain", "mode", "said"),
    [
        ({"kind": "saw"}, "force", "unknown; known: .*constant"),
        ("sine", "force", "mapping with the key 'kind'"),
        ({"kind": "constant"}, "force", "needs 'value'"),
        ({"kind": "constant", "value": "1"}, "force", "'value' must be a finite number"),
        ({"kind": "constant", "value": float("nan")}, "force", "'value' must be a finite number"),
        ({"kind": "constant", "value": 1.0, "hue": 2}, "force", "no key 'hue'"),
        ({"kind": "ramp", "end": 1.0, "begins": 2.0, "ends": 1.0}, "force", "'ends' must come"),
        ({"kind": "moves", "waypoints": []}, "force", "list of pairs"),
        ({"kind": "moves", "waypoints": [[0.0, 1.0]]}, "force", "must be above"),
        ({"kind": "steps", "plateaus": []}, "force", "list of pairs"),
        ({"kind": "steps", "plateaus": [[1]]}, "force", "pairs"),
        ({"kind": "steps", "plateaus": [[0.0, 1.0]]}, "force", "must be above"),
        ({"kind": "triangle", "high": 1.0, "period": 0.0}, "force", "'period'"),
        (
            {"kind": "multisine", "amplitude": 1, "low": 0.51, "high": 0.52, "period": 10},
            "force",
            "multiples",
        ),
        ({"kind": "shuttle", "speeds": [0.1], "stroke": 0.1}, "displacement", "mode velocity"),
        ({"kind": "shuttle", "speeds": [], "stroke": 0.1}, "velocity", "list of speeds"),
        ({"kind": "shuttle", "speeds": [1.0], "stroke": 0.01}, "velocity", "before its blend"),
    ],
)
def test_nonsense_is_refused_with_its_key(plain, mode, said):
    with pytest.raises(ConfigError, match=said) as caught:
        profile_from(plain, mode, "trial 'x': motors.left.profile")
    assert "trial 'x': motors.left.profile" in str(caught.value)
