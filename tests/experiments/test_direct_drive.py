"""The arm's profile against MuJoCo's own mass matrix and Jacobian."""

import mujoco
import numpy as np
import pytest

from spirob.experiments.passive import profile
from spirob.geometry import ARM_LENGTH, spiral_arm
from spirob.plant.body import build_spec, hinge_stiffness
from spirob.plant.rig import Arm
from spirob.robot import Scene

PLACES = (0.2, 0.5, 0.95)


@pytest.fixture(scope="module")
def straight():
    model = build_spec(Arm(), Scene(), spiral_arm(24), 1e-3).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


@pytest.mark.parametrize("place", PLACES)
def test_inertia_and_mass_are_those_of_the_chain(straight, place):
    model, data = straight
    last = int(np.flatnonzero(spiral_arm().hinge_position < place * ARM_LENGTH)[-1])
    whole = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, whole)
    found = profile([place])
    assert found.inertia[0] == pytest.approx(whole[last, last] - model.dof_armature[last])
    assert found.mass[0] == pytest.approx(model.body_subtreemass[1 + last])


@pytest.mark.parametrize("place", PLACES)
def test_give_is_the_springs_seen_through_the_jacobian(straight, place):
    model, data = straight
    x = place * ARM_LENGTH
    last = int(np.flatnonzero(spiral_arm().hinge_position < x)[-1])
    jacobian = np.zeros((3, model.nv))
    mujoco.mj_jac(model, data, jacobian, None, np.array([x, 0.0, 0.0]), 1 + last)
    stiffness = hinge_stiffness(Arm(), spiral_arm())
    assert profile([place]).give[0] == pytest.approx(np.sum(jacobian[1] ** 2 / stiffness))


def test_from_base_to_tip_the_arm_gives_more_and_weighs_less():
    found = profile(np.linspace(0.05, 1.0, 20))
    assert (np.diff(found.give) > 0).all()
    assert (np.diff(found.mass) <= 0).all()
    assert (np.diff(found.inertia) <= 0).all()
    assert (np.diff(found.stiffness) <= 0).all()
