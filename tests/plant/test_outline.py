"""The outline of units that bend over their length: closed form, and an arm cut twice as fine."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.control import CURRENT, Schedule
from spirob.effects import find_effects
from spirob.geometry import spiral_arm
from spirob.plant import Plant, Rig
from spirob.plant.chain import SKIPPED, bow
from spirob.robot import Cylinder, Scene
from tests.physics.playing import winding

RIG = Rig()
FINE = replace(RIG, cut=2 * RIG.units)
BENDS = "arm.bends_per_hinge"


def wound(plant, diameter, changes, bowed=True):
    """What the left tendon has wound in [mm] when 2 A have closed the arm round a cylinder."""
    cycles = 2500
    current = np.column_stack([np.minimum(2.0, np.arange(cycles) / 1000), np.zeros(cycles)])
    across = plant.geometry.half_width[0] * np.exp(-0.1764 * 4 * np.pi * 0.67) + diameter / 2
    scene = Scene(cylinder=Cylinder(diameter, 0.31, across + 0.012, 0.3))
    session = plant.start(scene, changes)
    if not bowed:
        session.arm.bows[:] = 0.0
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
    assert not Plant(RIG).start(Scene(), {BENDS: 2.0}).arm.bows.any()


def test_outlines_follow_the_hinges_of_their_own_session_only():
    plant = Plant(RIG)
    scene = Scene(cylinder=Cylinder(0.04, 0.31, 0.05, 0.3))
    one, other = (plant.start(scene, {BENDS: 2.0}) for _ in range(2))
    straight = other._model.geom_pos.copy()
    current = np.column_stack([np.full(1500, 1.0), np.zeros(1500)])
    one.play(Schedule(np.full(2, CURRENT), current, 0.0 * current, np.full(2, 5.0)))
    q = one._data.qpos
    bend = np.append((q[:-1] + q[1:]) / 2, q[-1])
    moved = one._model.geom_pos[one.arm.outline, 1] - one.arm.heights
    # as of the start of the last step
    assert moved == pytest.approx(-np.outer(one.arm.bows * bend, np.ones(6)), abs=2e-5)
    assert np.abs(moved).max() > 1e-4
    assert np.array_equal(other._model.geom_pos, straight)


def test_a_wrap_comes_nearer_to_that_of_an_arm_cut_twice_as_fine():
    coarse, fine = Plant(RIG), Plant(FINE)
    stiffness = 2 * RIG.arm.base_stiffness  # of each hinge, where there are twice as many
    away = []
    for diameter in (0.03, 0.045, 0.065):
        exact = wound(fine, diameter, {"arm.base_stiffness": stiffness})
        rigid = wound(coarse, diameter, {BENDS: 2.0}, bowed=False)
        bowed = wound(coarse, diameter, {BENDS: 2.0})
        away.append([abs(rigid - exact), abs(bowed - exact)])
    rigid, bowed = np.transpose(away)
    assert (bowed < rigid).all()
    assert bowed.sum() < 0.75 * rigid.sum()  # less at 65 mm, where the tip's point touches


def deepest(arm, angles):
    """How far a corner of one unit lies within another, or its middle within one's end [m]."""
    heading = np.cumsum(angles)
    along = np.column_stack([np.cos(heading), np.sin(heading)])
    across = np.column_stack([-along[:, 1], along[:, 0]])
    base = np.vstack([[0.0, 0.0], np.cumsum(arm.unit_length[:, None] * along, axis=0)[:-1]])
    slope = np.tan(arm.unit_angle[0] / 2)
    found = 0.0
    for own in range(arm.units):
        w, length = arm.half_width[own], arm.unit_length[own]
        corners = [(x, side * w) for x in (slope * w, length - slope * w) for side in (1, -1)]
        for x, y in [*corners, (length, 0.0)]:
            point = base[own] + x * along[own] + y * across[own]
            for other in range(arm.units):
                if abs(own - other) <= SKIPPED:
                    continue
                way = point - base[other]
                u, v = way @ along[other], abs(way @ across[other])
                sunk = np.cos(arm.unit_angle[0] / 2) * np.minimum(
                    u - slope * v, arm.unit_length[other] - u - slope * v
                )
                found = max(found, min(sunk, arm.half_width[other] - v))
    return found


def test_a_curled_arm_stays_outside_of_itself():
    # friction in the guides bends the base first, so that the tip comes to it from behind
    friction = {"capstan_friction.friction": 0.06, "arm.base_stiffness": 0.15}
    plant = Plant(RIG, find_effects(["capstan_friction"]))
    played = plant.simulate(winding(0.06, 0.0, 4.0), Scene(), friction)
    assert np.degrees(np.abs(played.angles.sum(axis=1))).max() > 500.0
    sunk = [deepest(plant.geometry, q) for q in played.angles[2000::50]]
    assert max(sunk) < 2e-3
