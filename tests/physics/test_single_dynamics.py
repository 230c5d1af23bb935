"""The baseline without motor and winch: the same arm, answering at once."""

import numpy as np
import pytest

from spirob.plant import Plant
from spirob.plant.plant import single_dynamics
from spirob.robot import Scene
from tests.physics.playing import DIRECT, GEARED, currents, relative, rising, seconds


def test_a_commanded_force_accelerates_the_arm_in_its_own_cycle():
    force = np.zeros((50, 2))
    force[10:, 0] = 1.0
    alone = single_dynamics(GEARED, force)
    assert np.all(alone.shortening[:11] == 0.0)
    assert alone.shortening_rate[11, 0] > 0.0
    newton = GEARED.gains.newton_per_ampere
    coupled = Plant(GEARED).simulate(currents(force[:, 0] / newton, 0.0), Scene())
    # 18 kg of rotor lie between the command and the coupled arm
    assert coupled.shortening[-1, 0] < 0.1 * alone.shortening[-1, 0]


def test_pulled_by_the_tension_that_the_coupled_model_found_it_moves_the_same():
    t = seconds(1.0)
    coupled = Plant(DIRECT).simulate(currents(0.5 * rising(t, 0.5), 0.1), Scene())
    # row k of the tension acted in the last substep before cycle k
    alone = single_dynamics(DIRECT, np.vstack([coupled.tension[1:], coupled.tension[-1:]]))
    assert relative(alone.shortening, coupled.shortening) < 0.01
    assert relative(alone.angles, coupled.angles) < 0.01


def test_a_negative_force_does_not_push():
    pushed = single_dynamics(GEARED, np.tile([-3.0, 0.0], (20, 1)))
    assert np.all(pushed.shortening == pytest.approx(0.0, abs=1e-15))
