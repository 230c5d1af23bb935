"""What of a build the logs tell, and what is held."""

import numpy as np
import pytest

from spirob.diagnosis.criteria import Settings
from spirob.identify.fit import fit
from spirob.identify.residual import Residual, near
from spirob.logs.readers import Table
from spirob.machine.arm.replay import arm_trial
from spirob.machine.arm.shape import TOLD, TOLERANCES, gate
from spirob.plant import Plant
from tests.identify.known import moves
from tests.machine.arm.elsewhere import played, rig

NAMES = ["winch.efficiency", "arm.base_stiffness", "arm.bends_per_hinge"]
TRUE = {"winch.efficiency": 0.72, "winch.radius_difference": 0.02, "arm.stiffness_bow": 0.2}
SCALE = Settings().scale


@pytest.fixture(scope="module")
def bends():
    """Gentle bends on either side of an arm with unlike drums and a bowed stiffness."""
    logs = []
    for k, motor in enumerate(("left", "right")):
        bend = moves(motor, [[0.1, 0.0], [1.2, 0.05], [0.7, 0.012], [0.9, 0.04]], 0.3)
        columns = played({"name": motor, "role": "train", **bend, "duration": 3.0}, TRUE, k=k)
        logs.append(arm_trial(Table(motor, columns), rig(), "train")[0])
    return Residual(Plant(rig().machine()), logs)


@pytest.fixture(scope="module")
def built(bends):
    """Its numbers, drums and profile of the stiffness among them."""
    return fit(bends, [*NAMES, "winch.radius_difference", "arm.stiffness_bow"], {}, SCALE).changes


def test_drums_and_a_bowed_stiffness_are_found_again(bends, built):
    assert built["winch.radius_difference"] == pytest.approx(0.02, abs=0.002)
    assert built["arm.stiffness_bow"] == pytest.approx(0.2, abs=0.05)
    assert np.std(bends(built)) < 0.3 * np.std(bends({}))


def test_what_is_told_is_told_better_than_its_tolerance_and_what_is_held_is_not(bends, built):
    open_ = gate(near(bends, built), [*NAMES, *TOLERANCES], built, [*TOLERANCES], SCALE)
    assert sorted([*open_.seen, *open_.held]) == sorted(TOLERANCES)
    assert all(width < TOLD * TOLERANCES[n] for n, width in open_.seen.items())
    assert all(TOLD * TOLERANCES[n] <= w <= TOLERANCES[n] for n, w in open_.held.items())
    assert abs(built["winch.radius_difference"] - 0.02) < open_.seen["winch.radius_difference"]
    said = open_.told(built, bends.table)
    assert "winch.radius_difference = 0.0" in said[0]
    assert all(name in said[-1] for name in open_.held)


def test_of_an_arm_that_stands_nothing_is_told_beyond_the_tolerances(bends):
    still = Residual(bends.plant, [bends.trials[0].until(100)])
    open_ = gate(still, [*NAMES, *TOLERANCES], {}, [*TOLERANCES], SCALE)
    assert open_.seen == {}
    assert open_.held == pytest.approx(TOLERANCES, rel=0.05)
