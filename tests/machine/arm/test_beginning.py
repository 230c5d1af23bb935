"""Under which currents the arm rests as a log begins."""

import numpy as np
import pytest

from spirob.machine.arm.replay import first_level, held

NOISE = 5e-3  # A


def measured(true, seed=0):
    return true + np.random.default_rng(seed).normal(0.0, NOISE, len(true))


@pytest.mark.parametrize("seed", range(5))
def test_where_a_current_begins_is_told_from_where_it_goes(seed):
    t = 1e-3 * np.arange(50)
    for rest, change in ((0.08, 0.12 * (t > 0.005)), (0.3, 0.0 * t), (0.3, 8.0 * t**2 / 0.05)):
        assert first_level(measured(rest + change, seed)) == pytest.approx(rest, abs=4.0 * NOISE)
    assert first_level(measured(8.0 * t**2 / 0.05, seed)) == 0.0
    assert first_level(0.25 + 0.0 * t) == pytest.approx(0.25)
    assert first_level(0.0 * t) == 0.0


def test_an_arm_without_currents_is_not_held():
    quiet = np.column_stack([measured(np.zeros(50), seed) for seed in (0, 1)])
    assert held(quiet) is None
    assert held(quiet + np.array([0.1, 0.0])) == pytest.approx([0.1, 0.0], abs=NOISE)


def test_one_sample_says_nothing():
    assert first_level(np.array([0.05] + [0.0] * 49)) == 0.0
