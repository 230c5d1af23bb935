"""The untouched arm's own step is MuJoCo's, and is taken only where MuJoCo would find no touch."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.control import CURRENT, Schedule
from spirob.geometry import spiral_arm
from spirob.plant import Plant, Rig
from spirob.plant.body import build_spec
from spirob.plant.chain import chain_factor, chain_of, chain_solve, chain_step, is_free, outlines
from spirob.robot import Ball, Cylinder, Scene

RIG = Rig()
UNITS = RIG.units
NOWHERE = np.zeros(3)
STEP = 5e-4


def arm(scene=None, tip_mass=0.0, **changes):
    """A compiled arm and its chain."""
    body = replace(RIG.arm, **changes)
    model = build_spec(body, scene or Scene(), spiral_arm(UNITS), STEP, tip_mass=tip_mass).compile()
    return model, chain_of(model, UNITS, outlines(model, UNITS), np.zeros(UNITS))


def pose(seed, chain, spread):
    """Hinge angles within the end stops: an even bend and something of each hinge's own."""
    rng = np.random.default_rng(seed)
    bend = rng.uniform(-1, 1) + spread * rng.uniform(-1, 1, UNITS)
    return np.clip(bend, -0.999, 0.999) * chain[7]


@given(seed=st.integers(0, 10**6), tip=st.sampled_from([0.0, 0.02]), turn=st.floats(0.0, 6.3))
@settings(max_examples=60, deadline=None)
def test_a_step_is_the_step_of_mujoco(seed, tip, turn):
    down = {"gravity_x": 9.81 * np.cos(turn), "gravity_y": 9.81 * np.sin(turn)}
    model, chain = arm(tip_mass=tip, **down)
    rng = np.random.default_rng(seed)
    data = mujoco.MjData(model)
    data.qpos[:] = 0.3 * pose(seed, chain, 0.5)
    data.qvel[:] = rng.normal(0.0, 2.0, UNITS)
    data.qfrc_applied[:] = rng.normal(0.0, 0.3, UNITS) * chain[1] / chain[1, 0]
    q, v = data.qpos.copy(), data.qvel.copy()
    place, factor, work = np.zeros((8, UNITS)), np.zeros((4, UNITS)), np.zeros((2, UNITS))
    assert is_free(q, chain, NOWHERE, place)
    mujoco.mj_step1(model, data)
    expected, found = np.zeros((1, UNITS)), np.zeros(UNITS)
    mujoco.mj_solveM(model, data, expected, data.qfrc_applied[None])
    chain_factor(chain, place, 0.0, factor)
    chain_solve(place, factor, data.qfrc_applied, found)
    assert found == pytest.approx(expected[0], rel=1e-8, abs=1e-8 * np.abs(expected).max())
    chain_step(q, v, data.qfrc_applied, chain, place, model.opt.gravity, STEP, factor, work)
    mujoco.mj_step2(model, data)
    assert v == pytest.approx(data.qvel, abs=1e-9 * np.abs(data.qvel).max())
    assert q == pytest.approx(data.qpos, abs=1e-10)


@pytest.mark.parametrize("spread", [0.2, 1.0, 2.0])
@pytest.mark.parametrize("post", [None, Cylinder(0.04, 0.2, 0.09, 0.3)])
def test_what_counts_as_free_touches_nothing(spread, post):
    scene = Scene(cylinder=post)
    model, chain = arm(scene)
    data = mujoco.MjData(model)
    circle = NOWHERE if post is None else np.array([post.x, post.y, post.diameter / 2])
    place = np.zeros((8, UNITS))
    free = touched = 0
    for seed in range(1000):
        data.qpos[:] = pose(seed, chain, spread)
        mujoco.mj_fwdPosition(model, data)
        if is_free(data.qpos, chain, circle, place):
            free += 1
            assert data.nefc == 0
            assert data.ncon == 0
        elif data.nefc:
            touched += 1
    assert free > 700
    assert touched >= 10


def test_neighbours_but_one_do_not_meet_before_the_end_stops():
    model, chain = arm()
    data = mujoco.MjData(model)
    outline = outlines(model, UNITS)
    for signs in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        for i in range(UNITS - 2):
            data.qpos[:] = 0.0
            data.qpos[i + 1 : i + 3] = np.array(signs) * 0.9999 * chain[7, i + 1 : i + 3]
            mujoco.mj_fwdPosition(model, data)
            for own in outline[i]:
                for other in outline[i + 2]:
                    assert mujoco.mj_geomDistance(model, data, own, other, 0.1, None) > 0.0


def test_an_end_stop_is_no_free_pose():
    _, chain = arm()
    place = np.zeros((8, UNITS))
    q = np.zeros(UNITS)
    assert is_free(q, chain, NOWHERE, place)
    q[5] = -chain[7, 5]
    assert not is_free(q, chain, NOWHERE, place)


def wound(scene, own):
    """Response of the arm that a growing current closes, with MuJoCo alone or not."""
    cycles = 900
    current = np.column_stack([2.5 * np.arange(cycles) / cycles, np.full(cycles, 0.2)])
    session = Plant(RIG).start(scene, {"arm.bends_per_hinge": 2.0})
    if not own:
        session.arm.alone = 0
    schedule = Schedule(np.full(2, CURRENT), current, 0.0 * current, np.full(2, 5.0))
    return session.play(schedule)


@pytest.mark.parametrize("scene", [Scene(), Scene(cylinder=Cylinder(0.04, 0.25, 0.07, 0.3))])
def test_a_trial_is_that_of_mujoco_alone(scene):
    own, alone = wound(scene, own=True), wound(scene, own=False)
    assert np.abs(own.angles).max() > 0.3
    assert not np.array_equal(own.angles, alone.angles)  # rounding: the chain did take part
    assert np.abs(own.angles - alone.angles).max() < 1e-9
    assert np.abs(own.current - alone.current).max() < 1e-9


def test_what_moves_beside_the_arm_is_left_to_mujoco():
    ball = Ball(0.02, 0.005, 0.3, 0.2, 0.0, -1.0)
    session = Plant(RIG).start(Scene(ball=ball))
    assert not session.arm.alone
    before = session._data.qpos[UNITS + 1]
    still = np.zeros((100, 2))
    session.play(Schedule(np.full(2, CURRENT), still, still, np.full(2, 5.0)))
    assert session._data.qpos[UNITS + 1] == pytest.approx(before - 0.1, abs=1e-3)
