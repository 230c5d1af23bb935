"""Mirror symmetry, the direction of gravity, and the same bits from the same input."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, replace

import numpy as np
import pytest

from spirob.plant import Plant, Response
from spirob.plant.rig import Arm
from spirob.robot import Cylinder, Scene
from tests.physics.playing import RIGS, currents, rising, seconds

T = seconds(1.0)
PULL = 0.4 * rising(T, 0.5)


@pytest.mark.parametrize("ratio", RIGS)
def test_swapping_the_motors_mirrors_the_arm(ratio):
    plant = Plant(RIGS[ratio])
    left = plant.simulate(currents(PULL, 0.1), Scene())
    right = plant.simulate(currents(np.full(len(T), 0.1), PULL), Scene())
    assert np.abs(left.angles).max() > 0.05
    assert right.angles == pytest.approx(-left.angles, abs=1e-9)
    for name in ("current", "arm_current", "shortening", "displacement", "tension"):
        mirrored = getattr(right, name)[:, ::-1]
        assert mirrored == pytest.approx(getattr(left, name), rel=1e-6, abs=1e-9), name


def test_equal_pull_on_both_sides_keeps_the_arm_straight():
    response = Plant(RIGS["direct"]).simulate(currents(PULL, PULL), Scene())
    assert response.tension[-1].min() > 0.2
    assert np.abs(response.angles).max() < 1e-9


def sag(**gravity):
    rig = replace(RIGS["direct"], arm=Arm(**gravity))
    return Plant(rig).simulate(currents(np.zeros(300), -0.1), Scene()).angles


def test_gravity_across_the_arm_bends_it_the_way_it_points():
    assert sag(gravity_y=-9.81)[-1].sum() < -0.05
    assert sag(gravity_y=9.81)[-1].sum() > 0.05


def test_a_hanging_arm_stays_straight_and_a_lying_one_too():
    assert np.abs(sag(gravity_x=9.81)).max() < 1e-12
    assert np.abs(sag()).max() < 1e-12


def test_a_hanging_arm_is_stiffer_than_a_lying_one():
    def bend(**gravity):
        rig = replace(RIGS["direct"], arm=Arm(**gravity))
        schedule = currents(0.3 * rising(seconds(2.5), 1.0), -0.05)
        return np.abs(Plant(rig).simulate(schedule, Scene()).angles[-1].sum())

    assert bend(gravity_x=9.81) < 0.8 * bend()


def bits(response):
    return [getattr(response, f.name).tobytes() for f in fields(Response)]


def test_the_same_input_gives_the_same_bits_again_and_on_another_thread():
    # through contact with an object and slack, where any difference would grow
    scene = Scene(Cylinder(0.04, 0.29, 0.05))
    schedule = currents(2.0 * rising(T, 0.3), -0.5)
    plant = Plant(RIGS["geared"])
    first = bits(plant.simulate(schedule, scene))
    assert bits(plant.simulate(schedule, scene)) == first
    with ThreadPoolExecutor(4) as pool:
        played = list(pool.map(lambda _: bits(plant.simulate(schedule, scene)), range(4)))
    assert all(again == first for again in played)


def test_played_in_pieces_the_trial_is_the_same():
    schedule = currents(PULL, 0.1)
    plant = Plant(RIGS["geared"])
    whole = plant.simulate(schedule, Scene())
    session = plant.start(Scene())
    pieces = [session.play(currents(PULL[k : k + 100], 0.1)) for k in range(0, len(T), 100)]
    angles = np.concatenate([piece.angles[:-1] for piece in pieces])
    assert angles.tobytes() == whole.angles.tobytes()
