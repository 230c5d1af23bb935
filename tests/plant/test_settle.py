"""An arm that currents held before a trial: it rests under them, and lengths count from there."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.plant import Plant
from spirob.robot import Scene
from tests.physics.playing import GEARED, currents

BENT = {"arm.bends_per_hinge": 2.0}
HELD = np.array([0.3, 0.28])


@pytest.fixture(scope="module")
def responses():
    plant, still = Plant(GEARED), currents(np.full(500, HELD[0]), HELD[1])
    schedules = (replace(still, held=HELD), still)
    return [plant.simulate(schedule, Scene(), BENT) for schedule in schedules]


def test_it_rests(responses):
    resting, begun = responses
    assert np.ptp(resting.tension, axis=0).max() < 0.01 * np.ptp(begun.tension, axis=0).max()
    winch, motor = GEARED.winch, GEARED.motor
    pull = winch.efficiency * winch.gear_ratio * motor.torque_constant / winch.radius  # N/A
    assert resting.tension[-1] == pytest.approx(pull * HELD, rel=0.01)


def test_lengths_count_from_there(responses):
    resting, _ = responses
    assert resting.displacement[0] == pytest.approx(0.0, abs=1e-15)
    assert abs(resting.shortening[0, 0]) > 1e-4


def test_the_rotors_are_themselves_again():
    """Let go, they answer as heavy as they are."""
    free = currents(np.full(20, 0.3), 0.28)
    plant = Plant(GEARED)
    for mass in (1e-5, 4e-5):
        heavy = BENT | {"motor.rotor_inertia": mass}
        pulled = replace(free, reference=free.reference + np.array([0.3, 0.0]), held=HELD)
        rate = plant.simulate(pulled, Scene(), heavy).velocity[2, 0]
        push = 0.3 * 0.77 * 0.0203 * GEARED.winch.radius / GEARED.winch.gear_ratio / mass
        assert rate == pytest.approx(2e-3 * push, rel=0.3)
