"""A leader whose fit ended in a valley is found again from the data sheet."""

from dataclasses import replace

import pytest
from spirob.diagnosis.backward import anew, sides
from spirob.diagnosis.rungs import ROLES, Confirmed, Settings, scores_of

from spirob.effects import find_effects
from spirob.identify.fit import STEPS, fit
from tests.identify.known import residual, spirob

FRICTION, TILT = find_effects(["capstan_friction", "mount_tilt"])
TRUE = {"capstan_friction.friction": 0.08}
NAMES = ["winch.efficiency", "arm.base_stiffness", *TRUE]
SETTINGS = Settings(intervals=False, patience=3)


@pytest.fixture(scope="module")
def residuals():
    plant = spirob([FRICTION])
    return {role: residual(plant, TRUE, role) for role in ROLES}


@pytest.fixture(scope="module")
def settled(residuals):
    own = fit(residuals["train"], NAMES, TRUE, 0.05, 3, steps=STEPS[-1:], exact=False)
    scores, missed, errors = scores_of(own, residuals)
    return Confirmed((FRICTION,), 0.5, own, missed, errors, scores)


def test_a_fit_that_lost_its_way_is_replaced(residuals, settled):
    far = settled.fit.changes | {"arm.base_stiffness": 0.5, "capstan_friction.friction": 0.01}
    stuck = replace(settled.fit, changes=far, residual=residuals["train"](far), cost=1.0)
    scores, missed, errors = scores_of(stuck, residuals)
    lost = replace(settled, fit=stuck, scores=scores, missed=missed, errors=errors)
    told: list[str] = []
    better = anew(lost, residuals, SETTINGS, told.append)
    assert "from the data sheet" in told[0]
    assert better.fit.changes["capstan_friction.friction"] == pytest.approx(0.08, rel=0.1)
    assert better.scores["heldout"].rmse < 0.2 * scores["heldout"].rmse
    assert better.effects == (FRICTION,)
    assert better.gain == lost.gain


def test_a_fit_at_its_optimum_stands(residuals, settled):
    told: list[str] = []
    assert anew(settled, residuals, SETTINGS, told.append) is settled
    assert not told


def test_what_may_have_two_signs_is_begun_on_both_sides():
    problem = residual(spirob([FRICTION, TILT]), TRUE, "train")
    assert list(sides([FRICTION], problem)) == []
    half = problem.table.about["mount_tilt.roll"].high / 2
    assert list(sides([FRICTION, TILT], problem)) == [
        {"mount_tilt.roll": -half},
        {"mount_tilt.roll": half},
    ]


@pytest.mark.parametrize(("missed", "begun"), [(1.0, [0.0, -0.25, 0.25]), (1e-6, [0.0])])
def test_both_sides_are_begun_only_while_much_is_missed(monkeypatch, settled, missed, begun):
    """Every start is hopeless here, so that what was found stands."""
    residuals = {role: residual(spirob([FRICTION, TILT]), TRUE, role) for role in ROLES}
    scores = {r: replace(s, rmse=missed) for r, s in settled.scores.items()}
    found = replace(settled, effects=(TILT,), scores=scores)
    rolls = []

    def hopeless(problem, names, start, *given, **named):
        rolls.append(start.get("mount_tilt.roll", 0.0))
        return replace(settled.fit, cost=1e9)

    monkeypatch.setattr("spirob.diagnosis.backward.fit", hopeless)
    assert anew(found, residuals, SETTINGS, print) is found
    assert rolls == begun
