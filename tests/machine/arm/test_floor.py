"""What builds of a machine differ by is told without anything that was measured."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.diagnosis.criteria import Settings
from spirob.identify.builds import SCATTER, TOLERANCES, Builds, floor_of, hinges, holes
from spirob.identify.fit import fit
from spirob.identify.problem import effort_rms
from spirob.identify.residual import Residual
from spirob.logs.readers import Table
from spirob.machine.arm.replay import arm_trial
from spirob.plant import Plant
from tests.identify.known import moves
from tests.machine.arm.elsewhere import played, rig

NAMES = ["winch.efficiency", "motor.rotor_damping", "arm.base_stiffness"]
SCALE = Settings().scale
BENDS = {"arm.bends_per_hinge": 2.0}


def residual_of(hold, true):
    """A bend of either motor against this current."""
    logs = []
    for k, motor in enumerate(("left", "right")):
        bend = moves(motor, [[0.1, 0.0], [0.9, 0.03], [0.7, 0.012]], hold)
        columns = played({"name": motor, "role": "train", **bend, "duration": 2.0}, true, k=k)
        logs.append(arm_trial(Table(motor, columns), rig(), "train")[0])
    return Residual(Plant(rig().machine()), logs)


@pytest.fixture(scope="module")
def gentle():
    return residual_of(0.4, BENDS)


def test_most_drawn_builds_leave_less_once_they_are_fitted(gentle):
    """A machine of its own, scattered otherwise than any that was drawn, and fitted in full."""
    share = floor_of(gentle, gentle, Builds(BENDS, NAMES, SCALE, {})).share
    rng = np.random.default_rng(7)
    below = 0
    for _ in range(4):
        units = gentle.plant.rig.units
        scattered = gentle.plant.scattered(hinges(rng, units), holes(rng, units))
        machine = replace(gentle, plant=scattered)
        own = machine(BENDS) - gentle(BENDS)  # of the build, without the log's noise
        known = _Shifted(gentle, own - gentle(BENDS))
        left = fit(known, NAMES, BENDS, SCALE, exact=False).residual[gentle.rows]
        below += np.sqrt(np.mean(left**2)) < 1.2 * share * effort_rms(gentle)
    assert below >= 3


class _Shifted(Residual):
    """A residual with something added."""

    def __init__(self, of, added):
        super().__init__(of.plant, of.trials, of.filter, of.current, of.length, of.workers)
        self.added = added

    def many(self, points):
        return [self.added + r for r in super().many(points)]


def test_nothing_of_what_was_measured_takes_part(gentle):
    """But how large the effort is, which weighs the data sheet in the fit."""
    turned = [replace(t, current=-t.current) for t in gentle.trials]
    one, two = (
        floor_of(r, r, Builds(BENDS, NAMES, SCALE)).share
        for r in (gentle, replace(gentle, trials=turned))
    )
    assert two == pytest.approx(one, rel=1e-6)


def test_an_arm_that_buckles_has_a_higher_floor_and_known_numbers_a_lower_one(gentle):
    point = {"arm.bends_per_hinge": 0.9}
    buckling = residual_of(1.1, point)
    low = floor_of(gentle, gentle, Builds(BENDS, NAMES, SCALE))
    assert floor_of(buckling, buckling, Builds(point, NAMES, SCALE)).share > 3.0 * low.share
    assert floor_of(gentle, gentle, Builds(BENDS, NAMES, SCALE, {})).share < low.share
    assert f"{SCATTER:.0%}" in low.reason
    assert all(name in low.reason for name in TOLERANCES)
