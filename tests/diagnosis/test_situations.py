"""Slack and contact come from the model that is judged: its tension, its hinges, its scene."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.diagnosis import atlas as module
from spirob.diagnosis.atlas import situations
from spirob.robot import Cylinder, Scene
from tests.identify.known import residual, spirob


@pytest.fixture(scope="module")
def trials():
    return residual(spirob(), {})


def test_masks_follow_the_models_tension_sample_by_sample(trials):
    found = situations(trials, {})
    assert len(found) == len(trials.stretches())
    trial = trials.trials[0]
    (pulling,) = trials.driven(trial)
    tension = trials.respond({}, 0).tension[:: trials.filter.every]
    other = tension[:, 1 - pulling] < module.SLACK
    assert np.array_equal(found[0]["slack"]["antagonist slack"], other)
    assert len(other) == len(trials.stretches()[0].seconds)
    assert 0 < other.mean() < 0.2  # slack before the currents rise, then held taut


def test_a_gentle_bend_never_curls_to_the_end_stop_and_a_low_stop_is_met(trials, monkeypatch):
    assert not any(f["contact"]["curled to the end stop"].any() for f in situations(trials, {}))
    monkeypatch.setattr(module, "CLOSED", 0.2)
    assert situations(trials, {})[0]["contact"]["curled to the end stop"].any()


def test_an_object_in_the_scene_is_said(trials):
    scene = Scene(cylinder=Cylinder(0.04, 0.5, 0.5))
    near = replace(trials, trials=[replace(trials.trials[0], scene=scene)])
    assert "an object within reach" not in situations(trials, {})[0]["contact"]
    assert situations(near, {})[0]["contact"]["an object within reach"].all()
