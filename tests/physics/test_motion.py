"""A drum whose motion is given: the model says which current that asks for."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.control.law import CURRENT, MOTION
from spirob.control.schedule import Schedule
from spirob.effects import find_effects
from spirob.plant import Plant
from spirob.robot import Scene
from tests.physics.playing import DIRECT, GEARED, currents, relative, rising, seconds

T = seconds(1.6)
BENT = {"arm.bends_per_hinge": 2.0}
PULLS = currents(0.9 * rising(T, 1.2) - 0.2 * rising(T - 1.2, 0.4), 0.3 * rising(T, 0.3))
EFFECTS = (
    "coulomb_friction",
    "cogging",
    "torque_constant_saturation",
    "winding_heating",
    "direction_dependent_efficiency",
    "load_dependent_friction",
    "eccentric_winch",
    "capstan_friction",
    "creep",
    "gear_compliance",
    "joint_viscoelasticity",
    "constant_force",
    "current_offset",
    "current_lag",
    "encoder_eccentricity",
)


def followed(played, other):
    """The left drum moved as in `played`, the right motor at the same currents."""
    reference = np.column_stack([played.displacement[:, 0], other])
    mode = np.array([MOTION, CURRENT])
    return Schedule(mode, reference, np.zeros_like(reference), np.full(2, 5.0))


@pytest.mark.parametrize("rig", [GEARED, DIRECT])
@pytest.mark.parametrize("substeps", [1, 2, 4])
def test_the_models_own_motion_asks_for_its_own_current(rig, substeps):
    plant = Plant(rig, substeps=substeps)
    wanted = plant.simulate(PULLS, Scene(), BENT)
    found = plant.simulate(followed(wanted, PULLS.reference[:, 1]), Scene(), BENT)
    np.testing.assert_allclose(found.displacement[:-1, 0], wanted.displacement[:-1, 0], atol=1e-12)
    assert relative(found.current[:-1, 0], wanted.current[:-1, 0]) < 1e-3
    assert relative(found.arm_current[:-1, 0], wanted.arm_current[:-1, 0]) < 1e-3
    assert relative(found.displacement[:, 1], wanted.displacement[:, 1]) < 1e-5


@pytest.mark.parametrize("name", EFFECTS)
def test_so_it_does_with_an_effect(name):
    (effect,) = find_effects([name])
    plant = Plant(GEARED, [effect])
    nominal = {f"{name}.{f}": about.nominal for f, about in effect.parameters().items()}
    wanted = plant.simulate(PULLS, Scene(), BENT | nominal)
    schedule = followed(wanted, PULLS.reference[:, 1])
    right = plant.simulate(schedule, Scene(), BENT | nominal)
    without = plant.simulate(schedule, Scene(), BENT)
    missed, apart = (relative(x.current[:-1, 0], wanted.current[:-1, 0]) for x in (right, without))
    assert missed < min(1e-3, 0.2 * apart)


def test_an_arm_that_was_held_rests_and_counts_from_there():
    held = np.array([0.3, 0.28])
    still = currents(np.full(500, held[0]), held[1])
    resting = Plant(GEARED).simulate(replace(still, held=held), Scene(), BENT)
    begun = Plant(GEARED).simulate(still, Scene(), BENT)
    assert resting.displacement[0] == pytest.approx(0.0, abs=1e-15)
    assert np.ptp(resting.tension, axis=0).max() < 0.01 * np.ptp(begun.tension, axis=0).max()
    winch, motor = GEARED.winch, GEARED.motor
    pull = winch.efficiency * winch.gear_ratio * motor.torque_constant / winch.radius  # N/A
    assert resting.tension[-1] == pytest.approx(pull * held, rel=0.01)
    assert abs(resting.shortening[0, 0]) > 1e-4


def test_what_follows_begins_under_the_same_tension():
    held = np.array([0.3, 0.28])
    reference = np.column_stack([np.zeros(500), np.full(500, held[1])])
    mode, none = np.array([MOTION, CURRENT]), np.zeros_like(reference)
    moved = Schedule(mode, reference, none, np.full(2, 5.0), held)
    assert Plant(GEARED).simulate(moved, Scene(), BENT).current[1:, 0] == pytest.approx(
        held[0], abs=0.01
    )
