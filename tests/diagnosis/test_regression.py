"""Regression within bounds, and folds that others predict."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from spirob.diagnosis.regression import bounded, error, left_out_linear, products, step, steps

FREE = np.full(3, -np.inf), np.full(3, np.inf)


def drawn(seed, count=60, folds=4):
    random = np.random.default_rng(seed)
    columns = random.standard_normal((count, 3)) * [1.0, 1e3, 1e-3]
    residual = columns @ [-1.0, 2e-3, 300.0] + random.standard_normal(count)
    return columns, residual, np.arange(count) * folds // count


def test_a_fold_is_predicted_by_the_least_squares_of_the_others():
    columns, residual, folds = drawn(1)
    found = left_out_linear(columns, residual, folds, *FREE)
    for k in range(4):
        inside = folds == k
        best = np.linalg.lstsq(columns[~inside], -residual[~inside], rcond=None)[0]
        expected = residual[inside] + columns[inside] @ best
        np.testing.assert_allclose(found[inside], expected, atol=1e-6)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.floats(-2.0, 0.0), st.floats(0.0, 2.0))
def test_no_point_within_the_bounds_is_better(seed, low, high):
    columns, residual, folds = drawn(seed)
    sizes = np.array([1.0, 1e-3, 1e3])
    bounds = (low - 1e-3) * sizes, (high + 1e-3) * sizes
    found = step(products(columns, residual, folds), *bounds)
    assert np.all(found >= bounds[0] - 1e-9 * sizes)
    assert np.all(found <= bounds[1] + 1e-9 * sizes)
    least = np.sum((residual + columns @ found) ** 2)
    others = np.random.default_rng(0).uniform(*bounds, (200, 3))
    others = [*others, *(np.clip(found + 1e-3 * sizes * d, *bounds) for d in np.eye(3))]
    assert least <= min(np.sum((residual + columns @ x) ** 2) for x in others) * (1 + 1e-6)


@pytest.mark.parametrize("bound", [np.inf, 0.2])
def test_the_error_is_that_of_the_samples(bound):
    columns, residual, folds = drawn(2)
    low, high = np.array([-bound, -bound, -np.inf]), np.array([bound, bound, np.inf])
    sums = products(columns, residual, folds)
    left = left_out_linear(columns, residual, folds, low, high)
    assert error(sums, low, high) == pytest.approx(np.sum(left**2))
    assert steps(sums, low, high).shape == (4, 3)


def test_a_column_of_zeros_gets_nothing():
    columns, residual, folds = drawn(3)
    columns[:, 1] = 0.0
    assert step(products(columns, residual, folds), *FREE)[1] == 0.0


def test_columns_that_say_the_same_are_solved_within_bounds():
    rng = np.random.default_rng(5)
    one = rng.normal(size=400)
    columns = np.column_stack([one, one, one * 3.0, rng.normal(size=400)]) * 1e6
    sums = products(columns, -2.0e6 * one, np.repeat([0, 1], 200))
    low, high = np.array([-0.1, -np.inf, -np.inf, -np.inf]), np.array([0.1] + [np.inf] * 3)
    moved = step(sums, low, high)
    assert abs(moved[0]) <= 0.1
    assert moved @ [1.0, 1.0, 3.0, 0.0] == pytest.approx(2.0, rel=1e-3)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.integers(2, 12))
def test_it_is_the_least_squares_of_an_independent_solver(seed, count):
    random = np.random.default_rng(seed)
    columns = random.standard_normal((80, count)) @ random.standard_normal((count, count))
    residual = columns @ random.standard_normal(count) + random.standard_normal(80)
    low, high = -random.uniform(0.0, 1.0, count), random.uniform(0.0, 1.0, count)
    free = random.random(count) < 0.3
    low[free], high[free] = -np.inf, np.inf
    found = step(products(columns, residual, np.zeros(80, int)), low, high)
    other = lsq_linear(columns, -residual, (low, high), method="bvls", max_iter=200).x
    np.testing.assert_allclose(columns @ found, columns @ other, atol=1e-4)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 8), st.integers(1, 12))
def test_problems_within_bounds_are_solved_together_as_one_by_one(seed, n, count):
    random = np.random.default_rng(seed)
    columns = random.standard_normal((count, 40, n)) @ random.standard_normal((n, n))
    residual = random.standard_normal((count, 40))
    low, high = -random.exponential(0.05, n) - 1e-6, random.exponential(0.05, n) + 1e-6
    gram, side = (
        np.einsum("kij,kil->kjl", columns, columns),
        np.einsum("kij,ki->kj", columns, residual),
    )
    found = bounded(gram, side, low, high)
    for k, own in enumerate(found):
        exact = lsq_linear(columns[k], -residual[k], (low, high), method="bvls").x
        least, reached = (np.sum((residual[k] + columns[k] @ x) ** 2) for x in (exact, own))
        assert reached <= least * (1 + 1e-6)
        assert np.all((own >= low - 1e-9) & (own <= high + 1e-9))
    same = bounded(gram[:1], side, low, high)  # one square for all
    np.testing.assert_array_equal(same[0], found[0])
