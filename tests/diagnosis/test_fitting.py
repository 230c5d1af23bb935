"""Fits that lost their way are found again: from the data sheet, both sides, or a candidate's."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.diagnosis import fitting
from spirob.diagnosis.criteria import Settings
from spirob.diagnosis.fitting import (
    again_from,
    anew,
    begun,
    confirmed,
    off_its_bounds,
    parameters_of,
    shaped,
    sides,
)
from spirob.diagnosis.screen import screen
from spirob.effects import find_effects
from spirob.errors import SimulationError
from spirob.identify.fit import STEPS, fit
from tests.identify.known import residual, spirob

FRICTION, TILT, COGGING, OFFSET = find_effects(
    ["capstan_friction", "mount_tilt", "cogging", "current_offset"]
)
AMPLITUDE, STIFFNESS = "capstan_friction.friction", "arm.base_stiffness"
TRUE = {AMPLITUDE: 0.08}
BARE = ["winch.efficiency", STIFFNESS]
NAMES = [*BARE, *TRUE]
SETTINGS = Settings(intervals=False, patience=3)
ABOUT = spirob().table.about["winch.efficiency"]
LOWEST = ABOUT.reach(ABOUT.nominal)[0]


def lost(train, found, **changes):
    """The fit as if it had ended far away, at a high cost."""
    far = {**found.changes, **changes}
    return replace(found, changes=far, residual=train(far), cost=100.0 * found.cost)


def never(found):
    return False


@pytest.fixture(scope="module")
def train():
    return residual(spirob([FRICTION]), TRUE)


@pytest.fixture(scope="module")
def settled(train):
    return fit(train, NAMES, TRUE, 0.05, 3, steps=STEPS[-1:], exact=False)


def test_a_fit_that_lost_its_way_is_found_from_the_data_sheet(train, settled):
    stuck = lost(train, settled, **{STIFFNESS: 0.5, AMPLITUDE: 0.01})
    better = anew(train, [FRICTION], stuck, SETTINGS, never)
    assert better.changes[AMPLITUDE] == pytest.approx(0.08, rel=0.1)
    assert better.cost < 0.1 * stuck.cost


def test_a_fit_at_its_optimum_stands(train, settled):
    assert anew(train, [FRICTION], settled, SETTINGS, never) is settled


def test_what_may_have_two_signs_is_begun_on_both_sides():
    problem = residual(spirob([FRICTION, TILT]), TRUE)
    assert list(sides([FRICTION], problem)) == []
    half = problem.table.about["mount_tilt.roll"].high / 2
    assert list(sides([FRICTION, TILT], problem)) == [
        {"mount_tilt.roll": -half},
        {"mount_tilt.roll": half},
    ]


@pytest.mark.parametrize(("enough", "begun_at"), [(False, [0.0, -0.25, 0.25]), (True, [0.0])])
def test_both_sides_are_begun_only_while_much_is_missed(monkeypatch, settled, enough, begun_at):
    """Every start is hopeless here, so that what was found stands."""
    problem, rolls = residual(spirob([FRICTION, TILT]), TRUE), []

    def hopeless(problem, names, start, *given, **named):
        rolls.append(start.get("mount_tilt.roll", 0.0))
        return replace(settled, cost=1e9)

    monkeypatch.setattr(fitting, "fit", hopeless)
    assert anew(problem, [TILT], settled, SETTINGS, lambda found: enough) is settled
    assert rolls == begun_at


SLOW, FAST = 0.06, 1.2  # per turn; a fifth below, the slow one is within its bound still
WAVES = {
    "cogging.sine": 1.5e-3,
    "cogging.second_sine": 0.5e-3,
    "cogging.order": SLOW,
    "cogging.ratio": FAST / SLOW,
}
STRENGTHS = [f"cogging.{n}" for n in ("sine", "cosine", "second_sine", "second_cosine")]


@pytest.mark.parametrize("off", [1.3, 0.8])
def test_a_slow_wave_that_a_stroke_hardly_shows_is_found_from_a_third_off(off):
    """Both waves' orders are begun beside the truth, with amplitudes fitted to the wrong waves."""
    train = residual(spirob([COGGING]), WAVES)
    begin = {"cogging.order": off * SLOW, "cogging.ratio": FAST / SLOW / off}
    found = fit(train, STRENGTHS, begin, SETTINGS.scale, 2, steps=(0.03,), exact=False)
    after = shaped(train, [COGGING], found, Settings())
    assert set(after.estimates) == {n for n in parameters_of(COGGING) if n in train.table.about}
    assert after.cost < 0.5 * found.cost
    assert after.changes["cogging.order"] == pytest.approx(SLOW, rel=0.1)
    fast = np.prod([after.changes[f"cogging.{n}"] for n in ("order", "ratio")])
    assert fast == pytest.approx(FAST, rel=0.02)


def bounded(efficiency):
    train = residual(spirob(), {"winch.efficiency": efficiency})
    return train, fit(train, BARE, {}, 0.05, 3, exact=False)


def test_what_went_astray_to_a_bound_comes_back():
    train, good = bounded(0.8)
    found = off_its_bounds(train, lost(train, good, **{"winch.efficiency": LOWEST}), SETTINGS)
    assert found.changes["winch.efficiency"] == pytest.approx(0.8, rel=0.02)
    assert found.cost == pytest.approx(good.cost, rel=0.05)
    assert off_its_bounds(train, good, SETTINGS) is good, "within its bounds a fit stands"


def test_what_belongs_at_its_bound_stays_there():
    train, good = bounded(0.9 * LOWEST)
    assert good.changes["winch.efficiency"] == pytest.approx(LOWEST, rel=0.01)
    assert off_its_bounds(train, good, SETTINGS) is good


def test_numbers_alone_are_begun_from_afar():
    train = residual(spirob(), {"winch.efficiency": 0.8})
    found = begun(train, BARE, {STIFFNESS: 0.5, "winch.efficiency": LOWEST}, SETTINGS)
    assert found.fit.changes["winch.efficiency"] == pytest.approx(0.8, rel=0.02)
    assert found.vague == []


def test_the_numbers_alone_are_fitted_again_from_where_a_candidate_led_them(train, settled):
    """Without the candidate's own: they must do as well by themselves."""
    bare = fit(train, BARE, {}, 0.05, 3, exact=False)
    poor = lost(train, bare, **{STIFFNESS: 4.0 * bare.changes[STIFFNESS]})
    found = again_from(train, poor, settled.changes, parameters_of(FRICTION), SETTINGS)
    assert set(found.estimates) == set(BARE)
    assert AMPLITUDE not in found.changes
    assert found.cost == pytest.approx(bare.cost, rel=0.1)


def test_numbers_that_stand_well_stay_where_they_are(train, settled):
    bare = fit(train, BARE, {}, 0.05, 3, exact=False)
    assert again_from(train, bare, settled.changes, parameters_of(FRICTION), SETTINGS) is None


def test_a_candidate_that_cannot_be_simulated_ends_no_screening(monkeypatch):
    train = residual(spirob([FRICTION, OFFSET]), {**TRUE, "current_offset.offset": 0.04})
    bare = fit(train, BARE, {}, 0.05, 3, exact=False)
    plain = {s.effect: s.gain for s in screen(train, bare, BARE, [FRICTION, OFFSET], 0.05)}
    one = type(train).one

    def diverges(self, changes, index):
        if changes.get(AMPLITUDE, 0.0) > 0.02:
            raise SimulationError("the model became non-finite")
        return one(self, changes, index)

    monkeypatch.setattr(type(train), "one", diverges)
    seen = {s.effect: s.gain for s in screen(train, bare, BARE, [FRICTION, OFFSET], 0.05)}
    assert seen[OFFSET] == plain[OFFSET]
    assert 0.0 <= seen[FRICTION] < 0.5 * plain[FRICTION]


def test_several_candidates_are_confirmed_jointly_from_where_the_screening_left_each():
    train = residual(spirob([FRICTION, OFFSET]), {**TRUE, "current_offset.offset": 0.04})
    bare = fit(train, BARE, {}, 0.05, 3, exact=False)
    seen = screen(train, bare, BARE, [FRICTION, OFFSET], 0.05)
    one, pair = (confirmed(train, chosen, SETTINGS) for chosen in (seen[:1], seen))
    assert set(pair.estimates) >= {*one.estimates, AMPLITUDE, "current_offset.offset"}
    assert len(pair.estimates) == len(set(pair.estimates))
    assert pair.cost < 0.5 * one.cost < 0.5 * bare.cost
