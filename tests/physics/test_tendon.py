"""The tendon's geometry against finite differences, MuJoCo's own tendons and the hinge limits."""

import mujoco
import numpy as np
import pytest

from spirob.geometry import spiral_arm
from spirob.plant.body import build_spec
from spirob.plant.rig import Arm
from spirob.plant.tendon import guide_length, guides, half_angle, small_angle
from spirob.robot import MOTORS, Scene

UNITS = 24
LIMIT = 0.96 * spiral_arm(UNITS).unit_angle[0]
GUIDES = guides(spiral_arm(UNITS))


def lengths(side, angles, bends=1.0):
    """Length between guides and shortening per bend at each hinge, (2, N)."""
    rows = GUIDES if bends == 1.0 else guides(spiral_arm(UNITS), bends)
    return np.array(
        [
            guide_length(side, *half_angle(q, bends), *row)
            for q, row in zip(angles, rows, strict=True)
        ]
    ).T


def configurations(count=20):
    random = np.random.default_rng(1)
    return random.uniform(-LIMIT, LIMIT, (count, UNITS))


@pytest.mark.parametrize(("reach", "digits"), [(1.0, 3e-16), (2.0, 1e-11)])
def test_a_small_angles_sine_and_cosine(reach, digits):
    for x in np.linspace(-reach, reach, 2001):
        assert small_angle(x) == pytest.approx((np.sin(x), np.cos(x)), abs=digits)


@pytest.mark.parametrize("bends", [0.5, 1.0, 2.7, 16.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_jacobian_is_the_derivative_of_the_length(side, bends):
    step = 1e-6
    for angles in configurations():
        _, lever = lengths(side, angles, bends)
        ahead, behind = (lengths(side, angles + s, bends)[0] for s in (step, -step))
        assert side * lever == pytest.approx(-(ahead - behind) / (2 * step), abs=1e-9)


def test_two_bends_a_hinge_are_an_arm_cut_twice_as_fine():
    fine = guides(spiral_arm(2 * UNITS))
    for angle in (-0.2, 0.1, 0.22):
        half = half_angle(angle / 2, 1.0)
        twice = np.array([guide_length(1.0, *half, *row) for row in fine])
        _, lever = lengths(1.0, np.full(UNITS, angle), 2.0)
        # each hinge of the coarse arm stands where the first of its two begins
        assert twice[:, 1].reshape(UNITS, 2).mean(axis=1) == pytest.approx(lever, rel=0.04)


@pytest.mark.parametrize("bends", [1.0, 2.0, 5.0])
def test_two_tendons_push_a_hinge_over_with_the_tangent_of_half_its_gap(bends):
    q = np.full(UNITS, 1e-3)
    turning = lengths(1.0, q, bends)[1] - lengths(-1.0, q, bends)[1]  # at one newton each
    product, gap, sine, cosine, _ = guides(spiral_arm(UNITS), bends).T
    # heights differ a little on the two sides of a gap, which takes from it
    taper = gap / (gap + 4.0 * product * sine**2)
    expected = np.sqrt(product) * (sine - taper * cosine**2 / sine) / bends
    assert turning / q == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize(("exported", "tolerance"), [(False, 1e-12), (True, 1e-6)])
def test_lengths_and_jacobian_are_those_of_spatial_tendons(exported, tolerance):
    spec = build_spec(Arm(), Scene(), spiral_arm(UNITS), 5e-4, tendons=True)
    # the MJCF text holds seven digits
    model = mujoco.MjModel.from_xml_string(spec.to_xml()) if exported else spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    straight = data.ten_length.copy()
    for angles in configurations():
        data.qpos[:] = angles
        mujoco.mj_forward(model, data)
        jacobian = dense_jacobian(model, data)
        for m, side in enumerate((1.0, -1.0)):
            assert model.tendon(m).name == MOTORS[m]
            length, lever = lengths(side, angles)
            rest, _ = lengths(side, np.zeros(UNITS))
            shortening = np.sum(rest - length)
            assert shortening == pytest.approx(straight[m] - data.ten_length[m], abs=tolerance)
            assert side * lever == pytest.approx(-jacobian[m], abs=tolerance)


def dense_jacobian(model, data):
    """ten_J as (tendons, hinges); it is sparse by row."""
    out = np.zeros((model.ntendon, model.nv))
    values = np.asarray(data.ten_J).ravel()
    for m in range(model.ntendon):
        start = model.ten_J_rowadr[m]
        chosen = slice(start, start + model.ten_J_rownnz[m])
        out[m, model.ten_J_colind[chosen]] = values[chosen]
    return out


def test_past_the_angle_where_the_guides_meet_the_tendon_turns_the_hinge_no_further():
    angle = spiral_arm(UNITS).unit_angle[0]
    at, _ = lengths(1.0, np.full(UNITS, angle))
    beyond, lever = lengths(1.0, np.full(UNITS, angle + 0.05))
    assert lever == pytest.approx(0.0, abs=1e-15)
    assert beyond == pytest.approx(at, rel=1e-9)


def test_bending_left_shortens_the_left_tendon_and_lets_the_right_one_go():
    left, _ = lengths(1.0, np.full(UNITS, 0.1))
    right, _ = lengths(-1.0, np.full(UNITS, 0.1))
    rest, _ = lengths(1.0, np.zeros(UNITS))
    assert np.all(left < rest)
    assert np.all(right > rest)
