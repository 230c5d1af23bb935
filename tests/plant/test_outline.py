"""The outline of units that bend over their length: closed form, and an arm cut twice as fine."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.control.law import CURRENT
from spirob.control.schedule import Schedule
from spirob.geometry import spiral_arm
from spirob.plant import Plant, Rig
from spirob.plant.outline import bow
from spirob.robot import Cylinder, Scene

RIG = Rig()
FINE = replace(RIG, units=2 * RIG.units)
BENDS = "arm.bends_per_hinge"


def wound(plant, diameter, changes, bowed=True):
    """What the left tendon has wound in [mm] when 2 A have closed the arm round a cylinder."""
    cycles = 2500
    current = np.column_stack([np.minimum(2.0, np.arange(cycles) / 1000), np.zeros(cycles)])
    across = plant.geometry.half_width[0] * np.exp(-0.1764 * 4 * np.pi * 0.67) + diameter / 2
    scene = Scene(cylinder=Cylinder(diameter, 0.31, across + 0.012, 0.3))
    session = plant.start(scene, changes)
    if not bowed:
        session._bows[:] = 0.0
    limit = np.full(2, 5.0)
    played = session.play(Schedule(np.full(2, CURRENT), current, 0.0 * current, limit))
    return 1e3 * played.shortening[-1, 0]


@pytest.mark.parametrize("bends", [2.0, 3.0, 16.0])
def test_the_middle_of_a_unit_lies_where_even_winding_puts_it(bends):
    arm = spiral_arm(24)
    for angle in (0.05, 0.2, 0.4):
        apart = 1 / bends / np.tan(angle / 2 / bends) - 1 / np.tan(angle / 2)
        exact = arm.unit_length / 2 * apart
        assert bow(arm, bends) * angle == pytest.approx(exact, rel=0.02)


def test_a_point_hinge_has_a_straight_unit_and_no_object_needs_none():
    assert not bow(spiral_arm(24), 1.0).any()
    assert not Plant(RIG).start(Scene(), {BENDS: 2.0})._bows.any()


def test_edges_follow_the_hinges_of_their_own_session_only():
    plant = Plant(RIG)
    scene = Scene(cylinder=Cylinder(0.04, 0.31, 0.05, 0.3))
    one, other = (plant.start(scene, {BENDS: 2.0}) for _ in range(2))
    straight = other._model.geom_pos.copy()
    current = np.column_stack([np.full(1500, 1.0), np.zeros(1500)])
    one.play(Schedule(np.full(2, CURRENT), current, 0.0 * current, np.full(2, 5.0)))
    q = one._data.qpos
    bend = np.append((q[:-1] + q[1:]) / 2, q[-1])
    moved = one._model.geom_pos[one._outline, 1] - one._heights
    # as of the start of the last step
    assert moved == pytest.approx(-np.outer(one._bows * bend, [1, 1]), abs=2e-5)
    assert np.abs(moved).max() > 1e-4
    assert np.array_equal(other._model.geom_pos, straight)


def test_a_wrap_comes_nearer_to_that_of_an_arm_cut_twice_as_fine():
    coarse, fine = Plant(RIG), Plant(FINE)
    stiffness = 2 * RIG.arm.base_stiffness  # of each hinge, where there are twice as many
    for diameter in (0.03, 0.045, 0.065):
        exact = wound(fine, diameter, {"arm.base_stiffness": stiffness})
        rigid = wound(coarse, diameter, {BENDS: 2.0}, bowed=False)
        bowed = wound(coarse, diameter, {BENDS: 2.0})
        assert abs(bowed - exact) < 0.75 * abs(rigid - exact)
