"""Several starts lead out of a valley, and what the data do not tell goes back to nominal."""

import numpy as np
import pytest

from spirob.identify.fit import best_start, fit, fit_identifiable
from tests.identify.linear import Linear

SCALE = 0.05


class TwoValleys(Linear):
    """A shallow valley at the nominal number and a deep one at 2.5 times of it."""

    deep = np.log(2.5)

    def __init__(self):
        super().__init__([0.1], [1.0], 0.0)

    def __call__(self, changes):
        u = np.log(changes.get(self.names[0], 1.0))
        near = 0.7 * np.exp(-((u / 0.25) ** 2))
        height = 1.0 - near - np.exp(-(((u - self.deep) / 0.3) ** 2))
        return np.full(self.edges[-1], 0.01 * height)


def test_one_start_stays_in_its_valley_and_several_find_the_deeper_one():
    problem = TwoValleys()
    name = problem.names[0]
    alone = fit(problem, [name], {}, SCALE, exact=False)
    assert abs(np.log(alone.changes[name])) < 0.3
    begun = best_start(problem, [name], {}, SCALE, count=16)
    found = fit(problem, [name], begun, SCALE, exact=False)
    assert np.log(found.changes[name]) == pytest.approx(problem.deep, abs=0.1)


def test_the_same_starts_every_time():
    problem = TwoValleys()
    starts = [best_start(problem, problem.names, {}, SCALE, count=8, seed=3) for _ in range(2)]
    assert starts[0] == starts[1]


def test_a_number_that_the_data_hardly_hold_goes_back_to_nominal():
    problem = Linear([0.3, 1e-5], [1.3, 3.0], 1e-3)
    sure, vague = problem.names
    found, left = fit_identifiable(problem, problem.names, {vague: 1.7}, SCALE)
    assert left == [vague]
    assert list(found.estimates) == [sure]
    assert found.changes[vague] == 1.0  # wherever the search began
    assert found.changes[sure] == pytest.approx(1.3, rel=0.01)


class Buckles(Linear):
    """As if the search lost its way once the number that is hardly told stands at nominal."""

    def __call__(self, changes):
        lost = 1.0 if changes.get(self.names[1], 1.0) == 1.0 else 0.0
        return super().__call__(changes) + 0.2 * lost


def test_a_fit_that_loses_its_way_without_a_number_is_not_taken():
    problem = Buckles([0.3, 1e-5], [1.3, 3.0], 1e-3)
    sure, vague = problem.names
    found, left = fit_identifiable(problem, problem.names, {vague: 1.7}, SCALE)
    assert left == []
    assert list(found.estimates) == [sure, vague]
    assert found.changes[sure] == pytest.approx(1.3, rel=0.01)
