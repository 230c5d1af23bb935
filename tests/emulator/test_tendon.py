"""Laws of the tendons, free of and with friction on their guides."""

import numpy as np
import pytest
from scipy.optimize import brentq

from spirob.geometry import spiral_arm
from tests.emulator.conftest import calm, hinge_angles, loosen, mirrored, play

N = 48
ARM = spiral_arm(N)


def span(hinge, q, side):
    """Distance between the guides of a hinge turned by q, from rotated points."""
    flip = np.array([1.0, side])
    turn = np.array([[np.cos(q), -np.sin(q)], [np.sin(q), np.cos(q)]])
    after = turn @ (flip * ARM.guide_after[hinge])
    return np.linalg.norm(after - flip * ARM.guide_before[hinge])


def lever(hinge, q, side=1.0, step=1e-6):
    return -(span(hinge, q + step, side) - span(hinge, q - step, side)) / (2 * step)


def test_shortening_is_the_sum_of_rotated_guide_distances(machine):
    made = machine()
    made.state["phi"][0] = np.cumsum(np.linspace(-0.2, 0.25, N))
    made._advance(made.numbers, np.zeros(2), steps=0)
    q = hinge_angles(made)
    for m, side in enumerate((1.0, -1.0)):
        expected = sum(span(i, 0.0, side) - span(i, q[i], side) for i in range(N))
        assert made._scratch["shortening"][0, m] == pytest.approx(expected, rel=1e-9)
        levers = [lever(i, q[i], side) for i in range(N)]
        np.testing.assert_allclose(made._scratch["lever"][0, m], levers, rtol=1e-6)


@pytest.mark.parametrize(("ratio", "newtons"), [(1.0, 0.8), (1.0, 3.0), (3591 / 187, 3.0)])
def test_constant_tension_curls_every_hinge_to_its_own_equilibrium(machine, ratio, newtons):
    made = calm(machine(gear_ratio=ratio))
    loosen(made, (1,))
    p = made.numbers
    unit = p["efficiency"][0, 0] * ratio * p["torque_constant"][0, 0] / p["winch_radius"][0, 0]
    play(made, (newtons / unit, 0.0), 10000)
    assert made.state["tension"][0, 0] == pytest.approx(newtons, rel=0.02)
    tension = made.state["tension"][0, 0]
    for i in (0, 12, 24, 40, 47):

        def residual(q, i=i):
            stop = p["stop_stiffness"][0, i] * max(q - p["stop_angle"][0, i], 0.0)
            return p["stiffness"][0, i] * q + stop - tension * lever(i, q)

        expected = brentq(residual, 0.0, np.deg2rad(14.95))
        assert hinge_angles(made)[i] == pytest.approx(expected, rel=5e-3)


def test_stretch_at_rest_is_force_over_stiffness_also_in_the_end_stop(machine):
    made = calm(machine())
    loosen(made, (1,))
    for current in (0.1, 3.0):
        play(made, (current, 0.0), 8000)
        stretch = made.state["wound"][0, 0] - made._scratch["shortening"][0, 0]
        # the scratch holds the pose at the start of the last step
        expected = made.state["tension"][0, 0] / made.numbers["tendon_stiffness"][0, 0]
        assert stretch == pytest.approx(expected, rel=0.01)
    assert np.rad2deg(hinge_angles(made)).max() < 14.9


def test_tension_never_pushes_and_a_paid_out_tendon_is_slack(machine):
    made = machine()
    for _ in range(1500):
        play(made, (-0.5, 0.3), 1)
        assert (made.state["tension"][0] >= 0.0).all()
    assert made.state["tension"][0, 0] == 0.0
    assert made.state["tension"][0, 1] > 0.3


@pytest.mark.parametrize("effect", ["none", "guide_friction"])
def test_left_and_right_mirror_each_other(machine, effect):
    left, right = (mirrored(machine(effect)) for _ in range(2))
    play(left, (0.6, 0.05), 1200)
    play(right, (0.05, 0.6), 1200)
    np.testing.assert_allclose(left.state["phi"][0], -right.state["phi"][0], atol=1e-6)
    assert left.state["phi"][0, -1] > 1.0


def test_sliding_guides_leave_the_capstan_share_of_the_tension(machine):
    made = calm(machine("guide_friction"))
    loosen(made, (1,))
    friction = 0.07
    made.numbers["guide_friction"] = friction
    made.numbers["guide_load_exponent"] = 0.0
    play(made, (0.25, 0.0), 700)
    assert made._scratch["past"][0, 0, 0] > 0.01
    z = made.state["asperity"][0, 0]
    last = int(np.argmin(z > 0.999))  # guides before this one slide
    assert last > 10
    q = np.abs(hinge_angles(made))
    wrap = q[: last - 1].sum() + 0.5 * q[last - 1]
    assert made._scratch["share"][0, 0, last - 1] == pytest.approx(
        np.exp(-friction * wrap), rel=5e-3
    )


def test_guide_friction_costs_current_winding_in_and_saves_it_paying_out(machine):
    shares = []
    made = machine("guide_friction")
    loosen(made, (1,))
    for current in (0.6, 0.05):
        play(made, (current, 0.0), 2000)
        shares.append(made._scratch["share"][0, 0, -1])
    assert shares[0] < 0.9
    assert shares[1] > 1.1


def test_motion_converges_with_the_step(machine):
    tips = []
    for steps in (10, 20, 80):
        made = machine("guide_friction", strength=0.5, steps_per_cycle=steps)
        play(made, (0.6, 0.1), 800)
        tips.append(made.state["phi"][0, -1])
    assert abs(tips[1] - tips[2]) < 0.7 * abs(tips[0] - tips[2]) + 1e-6
    assert tips[0] == pytest.approx(tips[2], rel=0.01)
