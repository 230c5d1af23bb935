"""The curl at rest against an independent static solve.

Potential energy U(q) = Σ ½ k_i q_i² - F Δl(q) - Σ m_i g·r_i(q) is minimised within the stops by
scipy; positions and tendon lengths come from chained rotations of the published geometry.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy import optimize

from spirob.geometry import spiral_arm
from spirob.plant import Plant
from spirob.plant.body import hinge_stiffness, unit_inertia
from spirob.plant.rig import Arm, Motor
from spirob.robot import Scene
from tests.physics.playing import DIRECT, currents, rising, seconds

GEOMETRY = spiral_arm()


BEFORE = GEOMETRY.guide_before @ [1, 1j]
AFTER = GEOMETRY.guide_after @ [1, 1j]


def left_length(angles):
    """Length of the left tendon between guides [m], summed over hinges; points are x + iy."""
    return np.abs(AFTER * np.exp(1j * angles) - BEFORE).sum()


def centres(angles):
    """Centre of mass of each unit in the world, (N, 2) [m]."""
    unit = GEOMETRY.unit_length * np.exp(1j * np.cumsum(angles))
    middle = np.cumsum(unit) - unit / 2
    return np.column_stack([middle.real, middle.imag])


def static_curl(arm, force):
    """Hinge angles at rest under a tension of the left tendon [N]."""
    stiffness = hinge_stiffness(arm, GEOMETRY)
    mass, _ = unit_inertia(arm, GEOMETRY)
    gravity = np.array([arm.gravity_x, arm.gravity_y])

    def energy(angles):
        lifted = mass @ (centres(angles) @ gravity)
        return 1e3 * (0.5 * stiffness @ angles**2 + force * left_length(angles) - lifted)

    stop = arm.limit_ratio * GEOMETRY.hinge_angle[0]
    found = optimize.minimize(
        energy,
        np.full(24, 0.05),
        bounds=[(-stop, stop)] * 24,
        method="L-BFGS-B",
        options={"maxiter": 3000, "maxfun": 10**6, "ftol": 1e-15, "gtol": 1e-8},
    )
    return found.x


# lying, hanging, and across gravity; the larger forces drive the tip into its stops
CASES = [(0.3, {}), (1.0, {}), (0.5, {"gravity_x": 9.81}), (0.4, {"gravity_y": -2.0})]


@pytest.mark.parametrize(("force", "gravity"), CASES)
def test_the_curl_at_rest_is_the_minimum_of_potential_energy(force, gravity):
    arm = Arm(**gravity, damping_time=0.2)
    rig = replace(DIRECT, arm=arm, motor=Motor(rotor_damping=1e-3))  # settles sooner
    amperes = force * rig.winch.radius / (rig.winch.efficiency * rig.motor.torque_constant)
    response = Plant(rig).simulate(currents(amperes * rising(seconds(15.0), 3.0), -0.05), Scene())
    assert response.tension[-1] == pytest.approx([force, 0.0], rel=1e-3)
    expected = static_curl(arm, force)
    assert response.angles[-1] == pytest.approx(expected, abs=np.radians(0.02))
    assert response.angles[-1].sum() == pytest.approx(expected.sum(), rel=1e-4)
