"""A copy with other springs is the arm that a compilation with them would have made."""

import mujoco
import numpy as np

from spirob.geometry import PUBLISHED
from spirob.plant.body import build_spec, compiled
from spirob.plant.rig import Arm
from spirob.robot import Cylinder, Scene

SHAPE = PUBLISHED, PUBLISHED.units
STEP = 5e-4
OTHER = Arm(
    base_stiffness=0.123,
    stiffness_exponent=1.3,
    stiffness_bow=0.2,
    damping_time=0.013,
    bends_per_hinge=2.1,
    density=600.0,
)


def saved(model):
    """All of a model, as bytes."""
    buffer = np.zeros(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, buffer)
    return buffer


def test_springs_that_are_put_in_are_those_that_would_have_been_compiled():
    scene = Scene(cylinder=Cylinder(0.05, 0.1, 0.1))
    whole = build_spec(OTHER, scene, PUBLISHED.arm(SHAPE[1]), STEP, tip_mass=0.02).compile()
    whole.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    compiled(Arm(), scene, SHAPE, STEP, 0.02, b"")  # whose springs must not stay
    found = compiled(OTHER, scene, SHAPE, STEP, 0.02, b"")
    np.testing.assert_array_equal(saved(found), saved(whole))
