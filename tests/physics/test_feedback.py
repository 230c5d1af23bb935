"""The paper's feedback points close on what they are asked for: current, speed, length, force."""

import numpy as np
import pytest

from spirob.control import CURRENT, DISPLACEMENT, FORCE, VELOCITY, Schedule
from spirob.plant import Plant
from spirob.robot import Scene
from tests.physics.playing import GEARED, rising, seconds

T = seconds(2.5)
HOLD = 0.25  # A, of the other motor


def played(mode, wanted, rate=None, limit=5.0):
    rates = np.zeros_like(wanted) if rate is None else rate
    reference = np.column_stack([wanted, np.full_like(wanted, HOLD)])
    schedule = Schedule(
        np.array([mode, CURRENT]),
        reference,
        np.column_stack([rates, np.zeros_like(rates)]),
        np.array([limit, 5.0]),
    )
    return Plant(GEARED).simulate(schedule, Scene())


def test_current():
    response = played(CURRENT, 0.4 * rising(T, 0.5))
    assert response.current[-1, 0] == pytest.approx(0.4, abs=1e-3)


def test_velocity():
    wanted = 0.03 * rising(T, 0.5)
    response = played(VELOCITY, wanted)
    late = T > 1.5
    assert response.velocity[late, 0] == pytest.approx(wanted[late], rel=0.02)


def test_displacement():
    wanted = 0.04 * rising(T, 1.5)
    response = played(DISPLACEMENT, wanted, np.gradient(wanted, 1e-3))
    assert response.displacement[-1, 0] == pytest.approx(0.04, rel=0.01)


def test_force():
    # n i = F_ref + K (F_ref - n i + c v): the drag of a rotor that moves is made up for in part
    response = played(FORCE, 6.0 * rising(T, 0.5))
    gains, late = GEARED.gains, T > 1.0
    share = gains.force / (1.0 + gains.force)
    wanted = 6.0 + share * gains.drag * response.velocity[late, 0]
    assert wanted.min() > 6.2  # it moves
    assert gains.newton_per_ampere * response.current[late, 0] == pytest.approx(wanted, rel=0.01)
    # what the law takes for the tendon's force is that, rotor's acceleration and slip apart
    seen = gains.newton_per_ampere * response.current - gains.drag * response.velocity
    assert response.tension[late, 0].mean() == pytest.approx(seen[late, 0].mean(), rel=0.1)


@pytest.mark.parametrize("mode", [VELOCITY, DISPLACEMENT])
def test_the_command_stays_within_its_limit_and_comes_back_at_once(mode):
    # asked for more than 0.5 A can do, then for rest: a wound-up integral would go on pulling
    wanted = np.where(T < 1.0, 1.0, 0.0) if mode == VELOCITY else np.where(T < 1.0, 0.5, 0.0)
    response = played(mode, wanted, limit=0.5)
    assert np.abs(response.command[:, 0]).max() == pytest.approx(0.5)
    assert np.all(response.command[50:900, 0] == pytest.approx(0.5))
    assert response.command[1010:1060, 0].max() < 0.0
