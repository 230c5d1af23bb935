"""Laws of a ball and of a peg on a circle."""

import numpy as np
import pytest

from spirob.robot import Ball, Peg, Scene

BALL = Ball(diameter=0.016, mass=0.005, x=0.4, y=0.23, vx=0.0, vy=-2.0)
PEG = Peg(diameter=0.01, x=0.4, y=0.017, radius=0.005, period=0.1, phase=np.pi / 2)


def positions(made, scene, cycles):
    made.start(scene, "objects")
    out = np.zeros((cycles, 4))
    for k in range(cycles):
        made.cycle((0.02, 0.02))
        out[k] = made.state["object"][0]
    return out


def test_a_ball_flies_straight_until_it_meets_the_arm(machine):
    seen = positions(machine(), Scene(ball=BALL), 90)
    expected = BALL.y - 2e-3 * np.arange(1, 91)
    assert np.allclose(seen[:, 1], expected, atol=1e-12)
    assert np.all(seen[:, 0] == BALL.x)


def test_a_ball_loses_energy_to_the_arm_and_moves_it(machine):
    made, still = machine(), machine()
    seen = positions(made, Scene(ball=BALL), 300)
    positions(still, Scene(), 300)
    speed = np.hypot(seen[:, 2], seen[:, 3])
    assert speed[-1] < 0.8 * speed[0]
    moved = made.state["phi"][0] - still.state["phi"][0]
    assert moved[:24].min() < -0.05  # hit from the left, the arm before the ball turns right


def test_what_the_ball_loses_the_arm_gains(machine):
    """About the base hinge, of an arm that nothing holds, angular momentum stays."""
    made = machine()
    for name in ("tendon_stiffness", "tendon_damping"):
        made.numbers[name] = 1e-9
    made.numbers["stiffness"][0, 0] = made.numbers["damping"][0, 0] = 0.0
    made.start(Scene(ball=BALL), "momentum")
    whole, given = [], []
    for _ in range(130):
        made.cycle((0.0, 0.0))
        ball = made.state["object"][0]
        given.append(BALL.mass * (ball[0] * ball[3] - ball[1] * ball[2]))
        whole.append(given[-1] + angular_momentum(made))
    assert np.ptp(given) > 0.5 * abs(given[0])
    assert np.ptp(whole) < 0.02 * abs(given[0])


def angular_momentum(made):
    """Of the arm about its base hinge [kg·m²/s], from the same A_ij as its kinetic energy."""
    p, phi, rate = made.numbers[0], made.state["phi"][0], made.state["rate"][0]
    moment, length, own = p["first_moment"], p["length"], p["inertia"]
    n = len(phi)
    A = np.array(
        [
            [own[i] if i == j else moment[max(i, j)] * length[min(i, j)] for j in range(n)]
            for i in range(n)
        ]
    )
    return float(np.sum(A * np.cos(phi[:, None] - phi[None, :]) * rate[None, :]))


def test_a_peg_keeps_to_its_circle_whatever_it_meets(machine):
    made = machine()
    seen = positions(made, Scene(peg=PEG), 400)
    assert np.abs(made.state["phi"][0]).max() > 1e-4  # it did meet the arm
    angle = PEG.phase + 2 * np.pi * 1e-3 * np.arange(1, 401) / PEG.period
    assert np.allclose(seen[:, 0], PEG.x + PEG.radius * np.cos(angle), atol=1e-9)
    assert np.allclose(seen[:, 1], PEG.y + PEG.radius * np.sin(angle), atol=1e-9)


@pytest.mark.parametrize("mass", [1e-4, 1e-2, 1.0])
def test_balls_of_any_mass_stay_finite(machine, mass):
    ball = Ball(0.016, mass, 0.4, 0.06, 0.0, -2.0)
    made = machine()
    seen = positions(made, Scene(ball=ball), 200)
    assert np.isfinite(seen).all()
    assert made._scratch["depth"][0] < 2e-3
