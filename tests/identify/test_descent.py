"""Gauss-Newton with corrected derivatives finds minima in few evaluations, inside its box."""

import numpy as np
import pytest

from spirob.identify.descent import SHORTEST, Anchor, descend, linear_step, robust_cost


def box_around(u):
    return np.full(len(u), -5.0), np.full(len(u), 5.0)


class Counted:
    """Rosenbrock's valley as a residual, counting."""

    def __init__(self):
        self.count = 0

    def value(self, u):
        self.count += 1
        return np.array([10.0 * (u[1] - u[0] ** 2), 1.0 - u[0]])

    def differences(self, u, at):
        return np.column_stack([(self.value(u + 1e-6 * e) - at) / 1e-6 for e in np.eye(2)])


def test_it_walks_through_rosenbrocks_valley():
    f = Counted()
    found = descend(f.value, f.differences, np.array([-1.2, 1.0]), box_around, 1e3, 60, 1e-9)
    assert found.u == pytest.approx([1.0, 1.0], abs=1e-3)


def test_a_linear_problem_takes_one_step():
    f = Counted()
    a = np.array([[2.0, 1.0], [0.0, 3.0], [1.0, -1.0]])
    b = np.array([1.0, 2.0, 3.0])

    def value(u):
        f.count += 1
        return a @ u - b

    def differences(u, at):
        return a

    found = descend(value, differences, np.zeros(2), box_around, 1e6, 5, 1e-3)
    assert found.u == pytest.approx(np.linalg.lstsq(a, b)[0], abs=1e-6)
    cuts = sum(0.25**k >= SHORTEST for k in range(20))  # of the step that no longer helps
    assert f.count <= 3 + cuts


def test_it_stays_in_the_box():
    f = Counted()
    box = (np.full(2, -5.0), np.array([0.5, 5.0]))
    found = descend(f.value, f.differences, np.array([-1.2, 1.0]), lambda u: box, 1e3, 60, 1e-9)
    assert found.u[0] == pytest.approx(0.5, abs=1e-6)
    assert np.all(found.u <= box[1])


def test_without_data_the_anchor_holds():
    anchor = Anchor(np.array([0.3, -0.2]), width=0.5, noise=1.0)
    start = np.array([2.0, 2.0])
    found = descend(
        lambda u: np.zeros(3),
        lambda u, at: np.zeros((3, 2)),
        start,
        box_around,
        1.0,
        5,
        1e-3,
        anchor,
    )
    assert found.u == pytest.approx(anchor.place, abs=1e-6)
    assert anchor.cost(anchor.place) == 0.0
    assert anchor.cost(anchor.place + np.array([0.5, 0.0])) == pytest.approx(0.5)


def test_outliers_pull_a_linear_step_less():
    slopes = np.ones((11, 1))
    residual = np.zeros(11)
    residual[0] = -11.0
    wide = (np.array([-10.0]), np.array([10.0]))
    assert linear_step(residual, slopes, wide, scale=1e6)[0] == pytest.approx(1.0, abs=1e-6)
    assert linear_step(residual, slopes, wide, scale=0.1)[0] < 0.3


def test_the_robust_cost_is_quadratic_near_and_linear_far():
    assert robust_cost(np.array([1e-3]), 1.0) == pytest.approx(0.5e-6, rel=1e-3)
    assert robust_cost(np.array([1e3]), 1.0) == pytest.approx(1e3, rel=1e-2)
