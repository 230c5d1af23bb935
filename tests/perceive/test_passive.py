"""The passive detector: silent in noise, the same at every scale, blind to which side is pushed."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.perceive.passive import (
    REGIONS,
    PassiveDetector,
    PassiveSettings,
    Response,
    features,
    learned,
    region,
)

COUNT = 20 / 16384


def told(currents, lengths=None, rules=None):
    """Every response of a signal, and when a push was being felt."""
    detector = PassiveDetector(rules)
    lengths = np.zeros_like(currents) if lengths is None else lengths
    found, felt = [], []
    for i, x in zip(currents, lengths, strict=True):
        found.append(detector.update(i, x))
        felt.append(detector.felt)
    return [f for f in found if f], np.array(felt)


def noisy(seconds, seed, sigma=0.005, size=0.0, at=1.5):
    """Two held currents in counts, with a pulse of 0.1 s in the left one."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(1e3 * seconds)) * 1e-3
    current = 0.8 * np.minimum(t / 0.05, 1.0)[:, None] + sigma * rng.normal(size=(len(t), 2))
    current[:, 0] += size * np.exp(-(((t - at - 0.05) / 0.03) ** 2))
    return np.rint(current / COUNT) * COUNT


@pytest.mark.parametrize("sigma", [0.0, 0.002, 0.02])
def test_noise_is_no_push(sigma):
    for seed in range(3):
        assert told(noisy(20.0, seed, sigma)) == ([], pytest.approx(np.zeros(20000)))


@pytest.mark.parametrize("size", [0.02, -0.05, 0.3])
def test_a_push_is_felt_at_once_and_described_when_its_window_is_over(size):
    (one,), felt = told(noisy(3.0, 1, size=size))
    assert 1500 < one.sample < 1580
    assert np.flatnonzero(felt)[0] == one.sample
    assert not felt[one.sample + 260 :].any()
    assert one.peak[0] == pytest.approx(abs(size), rel=0.35)
    assert one.peak[1] < 0.01


def test_two_pushes_are_two():
    current = noisy(4.0, 2, size=0.1) + noisy(4.0, 3, sigma=0.0, size=0.1, at=2.8)
    assert [round(r.sample, -2) for r in told(current)[0]] == [1500, 2800]


def test_an_arm_that_swings_on_is_pushed_once():
    current, t = noisy(4.0, 2, sigma=0.002), np.arange(4000) * 1e-3 - 1.5
    current[:, 0] += np.where(t > 0, 0.1 * np.exp(-t / 0.4) * np.sin(2 * np.pi * 3 * t), 0.0)
    assert [round(r.sample, -2) for r in told(current)[0]] == [1500]


@settings(max_examples=10, deadline=None)
@given(st.floats(0.5, 20.0))
def test_a_scale_changes_nothing(scale):
    rules = PassiveSettings(least=1e-6)
    one = told(noisy(2.5, 4, size=0.03), rules=rules)[0]
    other = told(scale * noisy(2.5, 4, size=0.03), rules=rules)[0]
    assert [r.sample for r in one] == [r.sample for r in other]
    assert other[0].peak == pytest.approx(scale * one[0].peak, rel=1e-6)


def test_features_do_not_ask_which_side():
    lengths = np.outer(np.clip(np.arange(2500) - 1500, 0, 100) * 1e-5, [1.0, -0.4])
    current = noisy(2.5, 5, size=0.08)
    one, other = (told(current[:, s], lengths[:, s])[0][0] for s in ([0, 1], [1, 0]))
    assert features(one) == pytest.approx(features(other))
    assert one.travel[0] == pytest.approx(np.ptp(lengths[: one.sample + 250, 0]), rel=0.2)


def test_regions_are_thirds_and_can_be_learned():
    assert [region(p) for p in (0.0, 0.33, 0.34, 0.66, 0.67, 1.0)] == [
        "base",
        "base",
        "middle",
        "middle",
        "tip",
        "tip",
    ]
    pushes, places = drawn(200, 6)
    classifier = learned(pushes[:150], places[:150])
    right = classifier.predict([features(r) for r in pushes[150:]]) == [
        region(p) for p in places[150:]
    ]
    assert right.mean() > 0.9
    assert set(classifier.classes_) == set(REGIONS)


def drawn(count, seed):
    """Responses to pushes of drawn strengths, and their places."""
    rng = np.random.default_rng(seed)
    places = rng.uniform(0.1, 1.0, count)
    return [made(p, rng.uniform(0.5, 2.0)) for p in places], places


def made(place, strength):
    """A push that is larger towards the tip, in current more than in length, and sooner."""
    current, length = strength * np.exp(6 * place) * 1e-4, strength * np.exp(3 * place) * 1e-4
    two = np.array([1.0, 0.8])
    later = np.full(2, 0.2 - 0.1 * place)
    return Response(0, current * two, later, length * two, later, 1.5 * length * two)
