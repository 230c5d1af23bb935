"""The detector for whole logs says what the streaming one says."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.perceive.contact import ContactDetector, ContactSettings, declared, levels

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
