"""What builds of a machine leave after a fit: as much as machines do that are built so."""

import numpy as np
import pytest

from spirob.diagnosis.criteria import Settings
from spirob.identify import builds
from spirob.identify.builds import LEVEL, RESOLUTION, Builds, floor_of, hinges, holes, most_of
from spirob.identify.fit import fit
from spirob.identify.measurement import Measurement
from spirob.identify.problem import effort_rms
from spirob.identify.residual import Residual
from spirob.trials import Trial
from spirob.trials.simulation import simulate
from tests.identify.known import moves, spirob

SCALE = Settings().scale
NAMES = ["winch.efficiency", "motor.rotor_damping", "arm.base_stiffness", "arm.bends_per_hinge"]
TRUE = {"arm.bends_per_hinge": 2.0}
DRAWN = spirob()
AGAINST = 0.8  # A, under which holes show
ROLES = {
    "train": [
        moves("left", [[0.1, 0.0], [0.9, 0.03], [0.8, 0.012]], AGAINST),
        moves("right", [[0.1, 0.0], [1.0, 0.035], [0.7, 0.02]], AGAINST),
    ],
    "validate": [moves("right", [[0.1, 0.0], [0.8, 0.025], [0.9, 0.01]], AGAINST)],
}


def recorded(plant, role):
    """The trials of a role as this machine plays them, compared with the model as drawn."""
    logs = []
    for k, plain in enumerate(ROLES[role]):
        trial = Trial.from_plain({"name": f"{role}_{k}", "role": role, **plain, "duration": 2.0})
        logs.append(Measurement.from_trace(simulate(plant, trial, TRUE, 0.0)))
    return Residual(DRAWN, logs)


def floor(train, unseen):
    return floor_of(train, unseen, Builds(TRUE, NAMES, SCALE, {}))


@pytest.fixture(scope="module")
def drawn():
    return recorded(DRAWN, "train"), recorded(DRAWN, "validate")


@pytest.fixture(scope="module")
def measured(drawn):
    return floor(*drawn)


def test_machines_that_are_built_so_leave_about_as_much_once_fitted(measured):
    """Played, logged and fitted in full, each other than any that was drawn."""
    rng, shares = np.random.default_rng(7), []
    for _ in range(5):
        machine = DRAWN.scattered(hinges(rng, 24), holes(rng, 24))
        train, unseen = recorded(machine, "train"), recorded(machine, "validate")
        found = fit(train, NAMES, TRUE, SCALE, exact=False)
        left = unseen(found.changes)[unseen.rows]
        shares.append(np.sqrt(np.mean(left**2)) / effort_rms(unseen))
    assert np.sum(np.array(shares) < measured.share) >= 4
    assert np.median(shares) > measured.share / 4


def test_the_floor_grows_with_what_builds_differ_by(drawn, measured, monkeypatch):
    monkeypatch.setattr(builds, "HOLE", 2.0 * builds.HOLE)
    assert 1.4 < floor(*drawn).share / measured.share < 2.8


def test_where_builds_do_not_differ_the_models_own_resolution_is_left(drawn, monkeypatch):
    monkeypatch.setattr(builds, "HOLE", 0.0)
    monkeypatch.setattr(builds, "SCATTER", 0.0)
    found = floor(*drawn)
    assert found.share == RESOLUTION
    assert "which is more" in found.reason


def test_the_same_bits_twice(drawn, measured):
    assert floor(*drawn) == measured


@pytest.mark.parametrize("freedom", [2, 6, 30])
def test_as_many_of_a_chi_squared_lie_below_as_are_meant_to(freedom):
    rng = np.random.default_rng(freedom)
    below = []
    for _ in range(300):
        drawn = rng.chisquare(freedom, builds.DRAWS)
        below.append(np.mean(rng.chisquare(freedom, 400) <= most_of(drawn)))
    assert np.mean(below) == pytest.approx(LEVEL, abs=0.015)


def test_a_unit_changes_nothing_and_equal_draws_are_what_they_are():
    drawn = np.random.default_rng(0).chisquare(4, 19)
    assert most_of(9.0 * drawn) == pytest.approx(9.0 * most_of(drawn))
    assert most_of([0.2, 0.2, 0.2]) == 0.2
    assert most_of([]) == 0.0
