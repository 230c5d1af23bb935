"""A replay in long steps, corrected at one point, stands for the exact one beside it."""

import numpy as np
import pytest

from spirob.errors import SimulationError
from spirob.identify.problem import effort_rms
from spirob.identify.residual import MOST, Near, Residual, near
from tests.identify.known import residual, spirob

HERE = {"winch.efficiency": 0.9}
BESIDE = {"winch.efficiency": 0.85, "arm.base_stiffness": 0.21}


@pytest.fixture(scope="module")
def exact():
    return residual(spirob(), {})


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


def test_at_its_own_point_it_is_exact(exact):
    found = near(exact, HERE)
    assert isinstance(found, Near)
    np.testing.assert_allclose(found(HERE), exact(HERE), atol=1e-12)


def test_beside_it_the_error_is_a_small_part_of_the_change(exact):
    found = near(exact, HERE)
    change = rms(exact(BESIDE) - exact(HERE))
    error = rms(found(BESIDE) - exact(BESIDE))
    assert 0.0 < error < 0.02 * change


def test_a_problem_without_a_cheaper_one_stays_itself(exact):
    coarse = Residual(exact.plant.coarse(), exact.trials)
    assert near(coarse, HERE) is coarse


def test_where_long_steps_diverge_the_own_ones_are_taken(exact, monkeypatch):
    found = near(exact, HERE)

    def diverges(*arguments, **named):
        raise SimulationError("the model became non-finite after 0.1 s")

    monkeypatch.setattr(found.plant, "simulate", diverges)
    np.testing.assert_array_equal(found(BESIDE), exact(BESIDE))


def test_a_large_correction_is_not_trusted(exact, monkeypatch):
    whole = exact(HERE)
    shift = 2.0 * MOST * effort_rms(exact)
    coarse = type(exact.plant.coarse())
    simulate = coarse.simulate

    def off(self, *arguments, **named):
        found = simulate(self, *arguments, **named)
        found.current[:] += shift * (self.substeps == 1)
        return found

    monkeypatch.setattr(coarse, "simulate", off)
    assert near(exact, HERE) is exact
    np.testing.assert_array_equal(exact(HERE), whole)
