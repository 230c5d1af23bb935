"""A fit that a bound led astray is found again from the data sheet's value of what is bound."""

from dataclasses import replace

import pytest
from spirob.diagnosis.ladder import off_its_bounds
from spirob.diagnosis.rungs import Settings

from spirob.identify.fit import fit
from tests.identify.known import residual, spirob

NAMES = ["winch.efficiency", "arm.base_stiffness"]
SETTINGS = Settings(intervals=False, patience=3)
ABOUT = spirob().table.about["winch.efficiency"]
LOWEST = ABOUT.reach(ABOUT.nominal)[0]


def fitted(efficiency):
    train = residual(spirob(), {"winch.efficiency": efficiency})
    return train, fit(train, NAMES, {}, 0.05, 3, exact=False)


def test_what_went_astray_to_a_bound_comes_back():
    train, good = fitted(0.8)
    far = good.changes | {"winch.efficiency": LOWEST}
    stuck = replace(good, changes=far, residual=train(far), cost=100.0 * good.cost)
    found = off_its_bounds(train, stuck, SETTINGS)
    assert found.changes["winch.efficiency"] == pytest.approx(0.8, rel=0.02)
    assert found.cost == pytest.approx(good.cost, rel=0.05)


def test_within_its_bounds_a_fit_stands():
    train, good = fitted(0.8)
    assert off_its_bounds(train, good, SETTINGS) is good


def test_what_belongs_at_its_bound_stays_there():
    train, good = fitted(0.9 * LOWEST)
    assert good.changes["winch.efficiency"] == pytest.approx(LOWEST, rel=0.01)
    assert off_its_bounds(train, good, SETTINGS) is good
