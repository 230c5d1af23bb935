"""A fit finds the numbers of the model that made the data, and says how sure it is."""

import numpy as np
import pytest

from spirob.identify.fit import differences, fit
from spirob.identify.identifiability import probe
from spirob.identify.scaling import Scaling
from tests.identify.known import NOISE, residual, spirob

NAMES = ["winch.efficiency", "motor.rotor_damping", "arm.base_stiffness"]
TRUE = {"winch.efficiency": 0.71, "motor.rotor_damping": 8e-5, "arm.base_stiffness": 0.2}


@pytest.fixture(scope="module")
def data():
    return residual(spirob(), TRUE)


@pytest.fixture(scope="module")
def found(data):
    return fit(data, NAMES, {}, scale=0.05)


def test_the_true_numbers_leave_the_noise(data):
    passed = np.std(data.filter(np.random.default_rng(0).standard_normal(20_000)))
    assert np.std(data(TRUE)[data.rows]) == pytest.approx(NOISE * passed, rel=0.25)


def test_the_numbers_come_back(found):
    for name, true in TRUE.items():
        assert found.estimates[name].value == pytest.approx(true, rel=0.03)


def test_the_intervals_are_narrow_and_near_the_truth(found):
    for name, true in TRUE.items():
        estimate = found.estimates[name]
        width = estimate.high - estimate.low
        assert estimate.low < estimate.value < estimate.high
        assert 0 < width < 0.2 * true
        assert abs(estimate.value - true) < 1.5 * width
        assert not estimate.at_bound


@pytest.mark.parametrize("start", [(0.95, 3e-4, 0.1), (0.65, 3e-5, 0.06), (0.9, 2e-4, 0.5)])
def test_a_fit_from_elsewhere_ends_in_the_same_place(data, found, start):
    start = dict(zip(NAMES, start, strict=True))
    again = fit(data, NAMES, start, scale=0.05)
    for name in NAMES:
        assert again.estimates[name].value == pytest.approx(found.estimates[name].value, rel=0.02)


def test_the_same_fit_twice_gives_the_same_bits(data, found):
    again = fit(data, NAMES, {}, scale=0.05)
    assert again.changes == found.changes
    assert np.array_equal(again.residual, found.residual)


def test_outliers_do_not_move_the_fit(data, found):
    spoiled = residual(spirob(), TRUE)
    spoiled._measured[0] = spoiled._measured[0].copy()
    spoiled._measured[0][::40] += 2.0
    robust = fit(spoiled, NAMES, {}, scale=0.02)
    for name, true in TRUE.items():
        assert robust.estimates[name].value == pytest.approx(true, rel=0.15)


def test_derivatives_agree_with_wider_central_differences(data):
    scaling = Scaling(data.plant.table, NAMES)
    u = scaling.scaled(TRUE)
    columns = differences(data, scaling, u, {})
    for k in range(len(NAMES)):
        step = np.zeros(len(NAMES))
        step[k] = 5e-3
        ahead, behind = (data(scaling.physical(u + sign * step)) for sign in (1, -1))
        central = (ahead - behind) / 1e-2
        assert np.linalg.norm(columns[:, k] - central) < 0.02 * np.linalg.norm(central)


def test_a_number_that_moves_nothing_is_named_before_the_fit(data):
    gate = probe(data, [*NAMES, "drive.voltage_limit"], {})
    assert gate.silent == ["drive.voltage_limit"]
    assert "drive.voltage_limit" in gate.sentence


def test_drums_that_differ_show_in_the_length_that_the_other_motor_winds_in():
    """Of 0.6 %: more than a whole model may leave, and found where their difference is fitted."""
    apart = residual(spirob(), {"winch.radius_difference": 0.006})
    alike = fit(apart, NAMES, {}, scale=0.05)
    own = fit(apart, [*NAMES, "winch.radius_difference"], {}, scale=0.05)
    assert own.estimates["winch.radius_difference"].value == pytest.approx(0.006, abs=3e-4)
    other = np.setdiff1d(np.arange(len(own.residual)), np.arange(len(own.residual))[apart.rows])
    lengths = [np.sqrt(np.mean(found.residual[other] ** 2)) for found in (own, alike)]
    assert lengths[1] > 2 * lengths[0]
