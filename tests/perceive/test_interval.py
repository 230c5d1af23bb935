"""Intervals hold what they promise, and a wrap unlike the training gets no number."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.errors import ConfigError, DataError
from spirob.perceive.features import table
from spirob.perceive.interval import calibrated, coverage, estimate, half_width
from spirob.perceive.size import predict, train
from spirob.trials.trial import wrap_trial
from tests.perceive.conftest import simulate


@pytest.fixture(scope="module")
def model(known):
    return calibrated(train(known), known)


def wrapped(plant, *diameters):
    rng = np.random.default_rng(5)
    plain = [wrap_trial(f"new_{k}", "heldout", d, {}, rng) for k, d in enumerate(diameters)]
    return table([simulate(plant, given) for given in plain])


@pytest.mark.parametrize("confidence", [0.5, 0.8, 0.9])
def test_the_quantile_covers_as_conformal_prediction_says(model, confidence):
    """For exchangeable errors: at least c, and at most 1/(n + 1) more."""
    rng = np.random.default_rng(0)
    n, draws = 25, 4000
    held = 0
    for errors in np.abs(rng.standard_normal((draws, n + 1))):
        held += errors[-1] <= half_width(replace(model, errors=np.sort(errors[:-1])), confidence)
    noise = 3 * np.sqrt(0.25 / draws)
    assert confidence - noise <= held / draws <= confidence + 1 / (n + 1) + noise


def test_calibration_leaves_the_end_sizes_out(model, known):
    """Of those a held-out prediction is an extrapolation, which the finished model never makes."""
    inner = known["diameter"].between(0.011, 0.069).sum()
    assert len(model.errors) == inner
    assert np.all(np.diff(model.errors) >= 0)


def test_sizes_in_between_lie_in_their_intervals(model, plant):
    true = np.array([0.015, 0.025, 0.035, 0.045, 0.055, 0.065])
    found = estimate(model, wrapped(plant, *true))
    assert not any(e.refusal for e in found)
    said = coverage(found, true)
    assert said["covered"] >= 5 / 6
    assert said["width"] == pytest.approx(2 * half_width(model))


def test_the_estimate_is_the_prediction(model, known):
    sizes = predict(model, known)
    found = estimate(model, known)
    assert [e.diameter for e in found] == sizes.tolist()
    assert all(e.low <= e.diameter <= e.high for e in found)


def test_more_confidence_is_a_wider_interval(model):
    widths = [half_width(model, c) for c in (0.5, 0.7, 0.9)]
    assert widths == sorted(widths)
    with pytest.raises(DataError, match="support a confidence of at most"):
        half_width(model, 0.99)
    with pytest.raises(ConfigError, match="between 0 and 1"):
        half_width(model, 1.5)


def test_a_size_far_beyond_the_training_is_refused(model, plant):
    (found,) = estimate(model, wrapped(plant, 0.15))
    assert "no size, because" in found.refusal
    assert np.isnan([found.diameter, found.low, found.high]).all()
    said = coverage([found], np.array([0.15]))
    assert said["refused"] == 1.0
    assert np.isnan(said["covered"])


def test_a_strange_feature_is_refused_by_name(model, known):
    strange = known.iloc[:1].copy()
    strange["end_stroke"] += 1.0
    (found,) = estimate(model, strange)
    assert "end_stroke lie far outside the training range" in found.refusal


def test_a_model_without_calibration_says_so(known):
    with pytest.raises(DataError, match="not calibrated"):
        estimate(train(known), known)
