"""What a model explains of each log's current, and logs that it does not explain."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.errors import DataError
from spirob.identify.intervals import score
from spirob.identify.residual import SENSE, explained, refuse_senseless
from tests.identify.known import residual, spirob


@pytest.fixture(scope="module")
def logs():
    return residual(spirob(), {})


def test_the_right_model_explains_nearly_all_and_is_not_refused(logs):
    missed = logs({})
    assert set(explained(logs, missed)) == {"train_0", "train_1"}
    assert min(explained(logs, missed).values()) > 0.99
    refuse_senseless(logs, missed)


def test_a_model_that_says_the_mean_explains_nothing(logs):
    """R² of a constant is zero, log by log."""
    measured, missed = logs.measured(), np.zeros(logs.edges[-1])
    for low, high in zip(logs.edges[:-1], logs.edges[1:], strict=True):
        rows = np.flatnonzero(logs.rows[low:high]) + low
        missed[rows] = measured[rows].mean() - measured[rows]
    assert list(explained(logs, missed).values()) == pytest.approx([0.0, 0.0], abs=1e-12)
    with pytest.raises(DataError, match="the columns of the two motors exchanged"):
        refuse_senseless(logs, missed)


def test_the_worst_log_is_named(logs):
    missed = np.zeros(logs.edges[-1])
    missed[logs.edges[1] :] = 3.0  # A
    with pytest.raises(DataError, match="least in train_1"):
        refuse_senseless(logs, missed)


def test_logs_that_differ_in_level_alone_are_not_explained_by_their_levels(logs):
    """Of all currents together half is explained, of those of each log nothing."""
    measured, missed = logs.measured(), np.zeros(logs.edges[-1])
    apart = replace(logs, trials=[replace(logs.trials[0], current=logs.trials[0].current + 2.0)])
    apart = replace(apart, trials=[*apart.trials, logs.trials[1]])
    measured = apart.measured()
    for low, high in zip(apart.edges[:-1], apart.edges[1:], strict=True):
        rows = np.flatnonzero(apart.rows[low:high]) + low
        missed[rows] = measured[rows].mean() - measured[rows]
    rows = apart.rows
    assert score(measured[rows], measured[rows] + missed[rows]).r2 > SENSE
    with pytest.raises(DataError, match="explains 0% of the current"):
        refuse_senseless(apart, missed)
