"""Samples count by how far builds are apart in them."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.diagnosis.criteria import Settings
from spirob.identify.builds import WEIGHTS, Builds, counting, floor_of, weighted
from spirob.identify.measurement import Measurement
from spirob.identify.problem import effort_rms
from spirob.identify.residual import Residual
from spirob.trials import Trial
from spirob.trials.simulation import simulate
from tests.identify.known import moves, spirob

NAMES = ["winch.efficiency", "motor.rotor_damping", "arm.base_stiffness"]
RIGHT = 3e-3  # A


def logs(hold, bends):
    """Three bends against this current, by role, and the builds of the machine that made them."""
    plant, numbers, found = spirob(), {"arm.bends_per_hinge": bends}, {}
    for k, role in enumerate(("train", "validate", "heldout")):
        bend = moves("left", [[0.1, 0.0], [0.8, 0.012], [0.7, 0.004 + 1e-3 * k]], hold)
        trial = Trial.from_plain({"name": role, "role": role, **bend, "duration": 1.6})
        found[role] = Residual(
            plant, [Measurement.from_trace(simulate(plant, trial, numbers, 0.0))]
        )
    return found, Builds(numbers, NAMES, Settings().scale, {})


@pytest.fixture(scope="module")
def snapping():
    return logs(1.1, 0.9)


@pytest.fixture(scope="module")
def weights(snapping):
    return weighted(*snapping, RIGHT)


def test_each_sample_counts_by_its_own_variance(snapping, weights):
    plain, builds = snapping
    further = [plain["validate"], plain["heldout"]]
    apart = np.mean([e**2 for e in builds.left(plain["train"], further, WEIGHTS)], axis=0)
    first = 0
    for role, of in plain.items():
        here = apart[first : first + of.edges[-1]].reshape(3, -1)  # two currents and a length
        first += of.edges[-1]
        variance = RIGHT**2 + here.sum(axis=0)
        found = weights[role].weight(weights[role].trials[0])
        assert np.ptp(found**2 * variance) < 1e-9 * np.max(found**2 * variance)
        assert np.mean(found**2) == pytest.approx(1.0)


def test_model_and_measurement_are_weighted_alike(snapping, weights):
    plain, builds = snapping
    changes = {**builds.numbers, "winch.efficiency": 0.8}
    for role, of in weights.items():
        weight = np.tile(of.weight(of.trials[0]), 3)
        np.testing.assert_allclose(of(changes), weight * plain[role](changes), atol=1e-12)
        np.testing.assert_allclose(of.measured(), weight * plain[role].measured())


def test_an_arm_that_snaps_has_a_lower_floor_on_what_its_builds_agree_on(snapping, weights):
    plain, builds = snapping
    before, after = (floor_of(r["train"], r["validate"], builds) for r in (plain, weights))
    assert after.share < 0.7 * before.share
    worth = counting(weights["validate"])
    assert worth < 0.9
    assert f"{worth:.0%} of the samples" in after.reason


def test_an_arm_that_does_not_snap_keeps_nearly_all_of_its_samples():
    plain, builds = logs(0.4, 2.0)
    found = weighted(plain, builds, RIGHT)
    assert all(counting(of) > 0.9 for of in found.values())


def test_nothing_of_what_was_measured_takes_part(snapping, weights):
    """But how large the effort is, which weighs the data sheet in the fit."""
    plain, builds = snapping
    turned = {
        role: replace(of, trials=[replace(t, current=-t.current) for t in of.trials])
        for role, of in plain.items()
    }
    other = weighted(turned, builds, RIGHT)
    for role, of in weights.items():
        np.testing.assert_allclose(of.trials[0].weight, other[role].trials[0].weight, rtol=1e-6)
        assert effort_rms(other[role]) == pytest.approx(effort_rms(of))
