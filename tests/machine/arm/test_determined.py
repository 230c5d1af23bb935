"""Rows that the arm's numbers do not determine are left out; else all of them count."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.identify.residual import Residual
from spirob.logs.readers import Table
from spirob.machine.arm.replay import arm_trial
from spirob.machine.arm.rows import LEAST_TIME, determined, spread
from spirob.plant import Plant
from tests.identify.known import moves
from tests.machine.arm.elsewhere import played, rig

LIMIT = 3e-3  # A


def residual_of(hold, bends):
    """A bend of the model against this current, played with so many bends a hinge."""
    numbers = {"arm.bends_per_hinge": bends}
    bend = moves("left", [[0.1, 0.0], [0.8, 0.012], [0.7, 0.004], [0.8, 0.014]], hold)
    columns = played({"name": "bend", "role": "train", **bend, "duration": 3.0}, numbers)
    trial, _ = arm_trial(Table("log", columns), rig(), "train")
    return Residual(Plant(rig().machine()), [trial]), numbers


@pytest.fixture(scope="module")
def snapping():
    return residual_of(1.1, 0.9)


def test_an_arm_that_does_not_buckle_is_determined():
    residual, numbers = residual_of(0.4, 2.0)
    (trial,), share = determined(residual, numbers, LIMIT)
    assert share == 1.0
    assert trial.use.all()
    assert spread(residual, numbers, 0).max() < 1e-3


def test_where_hinges_snap_builds_are_apart(snapping):
    residual, numbers = snapping
    (trial,), share = determined(residual, numbers, LIMIT)
    assert share < 0.8
    assert trial.use[:100].all()  # before anything is taut
    apart = spread(residual, numbers, 0)
    np.testing.assert_array_equal(trial.use, apart <= max(LIMIT, apart[trial.use].max()))


def test_something_counts_in_any_case_and_what_was_left_out_stays_out(snapping):
    residual, numbers = snapping
    (trial,), _ = determined(residual, numbers, 0.0)
    assert np.count_nonzero(trial.use) >= 1e3 * LEAST_TIME
    out = np.arange(len(trial.use)) < 1500
    late = replace(residual, trials=[replace(residual.trials[0], use=~out)])
    (trial,), _ = determined(late, numbers, LIMIT)
    assert not trial.use[out].any()
