"""Intervals hold what they promise, whatever the noise's correlation and the data sheet say."""

import numpy as np
import pytest

from spirob.identify.fit import fit, polished
from spirob.identify.intervals import block_covariance, with_held
from tests.identify.linear import Linear, filtered_noise

SCALE = 0.05
DRAWS = 300


def covered(deviations, covariances):
    half = 1.96 * np.sqrt(np.array([np.diag(c) for c in covariances]))
    return np.mean(np.abs(deviations) <= half, axis=0)


def test_95_percent_intervals_cover_under_autocorrelated_noise():
    problem = Linear([0.1] * 7, [1.0] * 7, 0.0)
    slopes = problem.slopes
    solve = -np.linalg.pinv(slopes)
    random = np.random.default_rng(2)
    found, blocks, plain = [], [], []
    for _ in range(DRAWS):
        # smoother than the filter leaves it, as what a model lacks is
        noise = np.convolve(filtered_noise(random, 1e-3), np.ones(5) / 5, "same")
        step = solve @ noise
        residual = noise + slopes @ step
        found.append(step)
        blocks.append(block_covariance(slopes, residual, problem.edges, SCALE, problem.block))
        plain.append(np.linalg.inv(slopes.T @ slopes) * residual.var())
    share = covered(np.array(found), blocks)
    assert share.mean() > 0.92
    assert np.all((share > 0.90) & (share < 0.99))
    assert covered(np.array(found), plain).mean() < 0.80  # what the blocks are there for


def test_a_number_that_one_block_alone_tells_has_no_interval():
    problem = Linear([0.1, 0.1], [1.0, 1.0], 1e-3)
    slopes = problem.slopes.copy()
    slopes[problem.block :, 1] = 0.0
    found = block_covariance(slopes, problem.noise, problem.edges, SCALE, problem.block)
    assert np.sqrt(found[1, 1]) > 1.0
    assert np.sqrt(found[0, 0]) < 0.1


def test_with_a_number_held_the_others_have_the_intervals_of_a_fit_of_them_alone():
    problem = Linear([0.1, 0.1], [1.0, 1.0], 1e-3)
    problem.slopes[:, 1] = 0.95 * problem.slopes[:, 0] + 0.05 * problem.slopes[:, 1]
    one, other = problem.names
    both = fit(problem, problem.names, {}, SCALE)
    found = with_held(problem, both, [other], SCALE)
    assert list(found) == [one]
    alone = fit(problem, [one], {other: both.changes[other]}, SCALE).estimates[one]
    assert np.log([found[one].low, found[one].high]) == pytest.approx(
        np.log([alone.low, alone.high]), abs=1e-5
    )
    wide = both.estimates[one]
    assert np.log(wide.high / wide.low) > 3.0 * np.log(alone.high / alone.low)


def test_a_polished_fit_is_where_the_data_put_it():
    """The weak number lies far from the data sheet, and the data tell it to some percent."""
    true = [1.3, 3.0]
    problem = Linear([0.3, 2e-3], true, 1e-4)
    first = fit(problem, problem.names, {}, SCALE)
    last = polished(problem, first, SCALE)
    weak = problem.names[1]
    assert not first.estimates[weak].low < true[1] < first.estimates[weak].high
    for name, value in zip(problem.names, true, strict=True):
        estimate = last.estimates[name]
        assert estimate.low < value < estimate.high
        assert estimate.high / estimate.low < 1.6
    assert np.array_equal(last.residual, problem(last.changes))


def test_where_the_data_say_nothing_the_data_sheet_does():
    problem = Linear([0.3, 0.0], [1.3, 3.0], 1e-3)
    last = polished(problem, fit(problem, problem.names, {}, SCALE), SCALE)
    estimate = last.estimates[problem.names[1]]
    assert abs(np.log(estimate.value)) < 0.01
    assert estimate.low < 0.5
    assert estimate.high > 2.0
