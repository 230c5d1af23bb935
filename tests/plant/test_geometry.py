"""The arm's lengths come from the spiral's law, not from a table."""

import numpy as np
import pytest

from spirob.geometry import ARM_LENGTH, SPIRAL_GROWTH, SPIRAL_TURN, spiral_arm


def curled(arm):
    """Corners of the elastic axis with every hinge turned by Δθ, as complex numbers."""
    heading = arm.unit_angle[0] * np.arange(arm.units)
    return np.concatenate([[0.0], np.cumsum(arm.unit_length * np.exp(1j * heading))])


@pytest.mark.parametrize("units", [24, 48])
def test_fully_curled_the_axis_lies_on_the_logarithmic_spiral(units):
    arm = spiral_arm(units)
    corners = curled(arm)
    # a turn by Δθ and a shrinking by exp(-bΔθ) carry each unit into the next: about one pole
    carry = np.exp((1j - SPIRAL_GROWTH) * arm.unit_angle[0])
    pole = corners[1] / (1.0 - carry)
    about = corners - pole
    assert np.allclose(about[1:] / about[:-1], carry, rtol=1e-9)
    # r = a exp(bθ) with θ counted from the pole
    theta = np.unwrap(np.angle(about))
    law = np.abs(about[0]) * np.exp(-SPIRAL_GROWTH * (theta - theta[0]))
    assert np.abs(about) == pytest.approx(law, rel=1e-9)


@pytest.mark.parametrize("units", [24, 48])
def test_cut_finer_it_is_the_same_arm(units):
    arm = spiral_arm(units)
    assert arm.unit_length.sum() == pytest.approx(ARM_LENGTH)
    assert arm.unit_angle[0] * units == pytest.approx(SPIRAL_TURN)
    assert np.diff(arm.hinge_position) == pytest.approx(arm.unit_length[:-1])


def test_the_guides_of_a_hinge_coincide_when_its_faces_meet():
    arm = spiral_arm()
    x, y = arm.guide_after.T
    turn = np.exp(1j * arm.unit_angle[0])
    turned = (x + 1j * y) * turn
    before = arm.guide_before[:, 0] + 1j * arm.guide_before[:, 1]
    # on one ray from the hinge, apart by the tendon's slope over one face alone
    assert np.angle(turned / before) == pytest.approx(0.0, abs=1e-12)
    assert np.abs(turned - before).max() < 0.05 * np.abs(before).max()
