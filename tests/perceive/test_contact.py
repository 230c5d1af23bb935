"""Laws of the contact detector.

The detector for whole logs says what the streaming one says.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.errors import ConfigError, DataError
from spirob.perceive.contact import ContactDetector, ContactSettings, declared, levels

NEVER = {"absolute": 100.0, "relative": 100.0, "slope": 1e4}
FULL = 400  # samples until the windows of the default settings are full


def only(rule):
    """Settings in which one rule has the paper's threshold and the others never hold."""
    paper = {rule: ContactSettings().__dict__[rule]}
    return ContactSettings(**{**NEVER, **paper})


def listen(values, rules=None):
    detector = ContactDetector(rules)
    for value in values:
        detector.update(float(value))
    return detector.contact


def stepped(level, height, at=600, length=1000):
    values = np.full(length, float(level))
    values[at:] += height
    return values


@settings(max_examples=25, deadline=None)
@given(st.floats(-5, 5))
def test_a_constant_current_is_no_contact(level):
    assert listen(np.full(900, level)) is None


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("rule", "level", "height"), [("absolute", 2.0, 0.8), ("relative", 1.0, 0.5)]
)
def test_a_step_counts_only_above_its_threshold_and_within_20_ms(rule, level, height, sign):
    above, below = (sign * stepped(level, height * k) for k in (1.1, 0.98))
    found = listen(above, only(rule))
    assert found.rule == rule
    assert 600 <= found.sample <= 620
    assert found.baseline == pytest.approx(sign * level)
    assert listen(below, only(rule)) is None


@settings(max_examples=25, deadline=None)
@given(st.floats(0.5, 20), st.floats(0.1, 3))
def test_the_slope_is_that_of_a_ramp(slope, level):
    """While the baseline is still flat the rule sees the ramp's own slope, and judges by it."""
    k = np.arange(1000)
    values = level + slope * 1e-3 * np.maximum(k - 600, 0)
    found = listen(values, only("slope"))
    if slope > 6.1:
        assert found.sample <= 600 + 100 + 5
        assert found.slope <= slope * (1 + 1e-6)
    if slope < 5.9:
        assert found is None


def test_a_steep_ramp_is_told_within_20_ms_of_its_crossing():
    """A line of 12 A/s through half of the window has the slope 6 A/s in the whole of it."""
    values = 1.0 + 12e-3 * np.maximum(np.arange(1000) - 600, 0)
    assert 650 <= listen(values, only("slope")).sample <= 670


def test_slow_changes_of_load_pass():
    """From 1 to 3 A within two seconds: 1 A/s, 0.3 A above the rolling baseline."""
    assert listen(np.linspace(1.0, 3.0, 2000), only("absolute")) is None
    assert listen(np.linspace(1.0, 3.0, 2000), only("slope")) is None


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.5, 3.0))
def test_scaling_current_and_thresholds_scales_nothing_else(seed, scale):
    values = 1.0 + np.cumsum(np.random.default_rng(seed).normal(0, 0.02, 900))
    paper = ContactSettings()
    scaled = ContactSettings(
        absolute=scale * paper.absolute,
        slope=scale * paper.slope,
        least_baseline=scale * paper.least_baseline,
    )
    one, other = listen(values, paper), listen(scale * values, scaled)
    assert (one is None) == (other is None)
    if one is not None:
        assert other.sample == one.sample


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_it_is_odd_in_the_current(seed):
    values = 1.0 + np.cumsum(np.random.default_rng(seed).normal(0, 0.02, 900))
    one, other = listen(values), listen(-values)
    assert (one is None) == (other is None)
    if one is not None:
        assert (other.sample, other.rule) == (one.sample, one.rule)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_ring_says_what_the_whole_signal_says(seed):
    """Against the same rules written over arrays, without memory."""
    values = 1.0 + np.cumsum(np.random.default_rng(seed).normal(0, 0.02, 1200))
    expected = None
    held = 0
    for k in range(FULL - 1, len(values)):
        seen = values[k + 1 - FULL : k + 1]
        base = seen[:300].mean()
        slope = np.polyfit(np.arange(100) * 1e-3, seen[300:], 1)[0]
        held = held + 1 if np.sign(base) * slope > 6.0 else 0
        if held == 5:
            expected = k
            break
    found = listen(values, only("slope"))
    assert (found.sample if found else None) == expected


def test_deaf_until_full_and_again_after_a_reset():
    detector = ContactDetector()
    for value in stepped(0.0, 5.0, at=FULL // 2, length=FULL - 1):
        assert detector.update(value) is None
    assert not detector.ready
    detector.reset()
    for value in stepped(1.0, 2.0):
        detector.update(value)
    assert detector.contact.sample <= 620
    first = detector.contact
    assert detector.update(1.0) is first  # it stays until the reset
    detector.reset()
    assert detector.contact is None


def test_sensor_noise_is_no_contact():
    rng = np.random.default_rng(0)
    assert listen(0.3 + rng.normal(0, 0.005, 60_000)) is None


def test_a_sample_that_is_no_number_is_refused():
    detector = ContactDetector()
    with pytest.raises(DataError, match="sample 0 of the current is nan"):
        detector.update(float("nan"))


def test_windows_and_periods_have_to_fit():
    with pytest.raises(ConfigError, match="does not fit"):
        ContactDetector(ContactSettings(window=0.01), period=0.01)


RULES = st.builds(
    ContactSettings,
    absolute=st.floats(0.05, 1.0),
    relative=st.floats(0.05, 1.0),
    slope=st.floats(0.5, 20.0),
    window=st.sampled_from([0.02, 0.1, 0.25]),
    baseline=st.sampled_from([0.01, 0.3]),
    smoothing=st.sampled_from([0.001, 0.01, 0.5]),
    confirm=st.sampled_from([0.0, 0.005, 0.02]),
)


@settings(max_examples=40, deadline=None)
@given(RULES, st.integers(0, 2**32 - 1), st.floats(-2, 2))
def test_both_declare_the_same_sample(rules, seed, start):
    values = start + np.cumsum(np.random.default_rng(seed).normal(0, 0.01, 900))
    detector = ContactDetector(rules)
    for value in values:
        detector.update(float(value))
    found = declared(levels(values, rules), rules)
    assert found == (None if detector.contact is None else detector.contact.sample)
    if detector.contact is not None:
        seen = levels(values, rules)
        told = detector.contact
        assert np.isclose(seen.baseline[found], told.baseline)
        assert np.isclose(seen.rise[found], told.rise)
        assert np.isclose(seen.slope[found], told.slope)


def test_a_log_shorter_than_the_windows_declares_nothing():
    seen = levels(np.linspace(0, 5, 399), ContactSettings())
    assert np.isnan(seen.rise).all()
    assert declared(seen, ContactSettings()) is None
    assert declared(levels(np.zeros(2), ContactSettings()), ContactSettings()) is None
