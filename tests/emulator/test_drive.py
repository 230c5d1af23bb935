"""Laws of the drive: current loop, rotor, stability over the whole range of motors."""

import itertools

import numpy as np
import pytest

from tests.emulator.conftest import hinge_angles, loosen, play


def test_free_rotor_spins_up_as_a_first_order_lag(machine):
    made = machine()
    loosen(made)
    made.state["wound"] = -100.0
    p = made.numbers
    inertia = p["rotor_inertia"][0, 0] + p["winch_inertia"][0, 0] / p["gear_ratio"][0] ** 2
    damping = p["rotor_damping"][0, 0]
    torque = p["efficiency"][0, 0] * p["torque_constant"][0, 0] * 0.4
    play(made, (0.4, 0.0), 200)
    time = 0.2 - 0.7e-3 / 1  # the current loop's own delay is below a millisecond
    expected = torque / damping * (1 - np.exp(-damping * time / inertia))
    assert made.state["rotor_speed"][0, 0] == pytest.approx(expected, rel=0.01)
    rpm = made.counts[0, 1]
    assert rpm == round(made.state["rotor_speed"][0, 0] * 60 / (2 * np.pi))


def test_current_follows_its_command_within_the_bandwidth(machine):
    made = machine()
    made.cycle((1.0, 0.0))
    assert made.state["current"][0, 0] == pytest.approx(1.0, abs=0.02)
    made.cycle((1.0, 0.0))
    assert made.counts[0, 2] == pytest.approx(1.0 * 16384 / 20, abs=4)


def test_rotor_cannot_outrun_the_supply(machine):
    made = machine()
    made.state["wound"] = -1e4
    made.numbers["rotor_damping"] = 0.0
    play(made, (5.0, 0.0), 4000)
    top = made.numbers["supply"][0] / made.numbers["torque_constant"][0, 0]
    assert 0.97 * top < made.state["rotor_speed"][0, 0] < 1.01 * top


def test_gear_carries_what_the_tendon_takes(machine):
    made = machine()
    loosen(made, (1,))
    play(made, (0.5, 0.0), 5000)
    torque = made.state["tension"][0, 0] * made.numbers["winch_radius"][0, 0]
    assert made.state["gear_torque"][0, 0] == pytest.approx(torque, rel=0.01)


CORNERS = list(itertools.product((5e-6, 5e-4), (1e-5, 1e-3), (1.0, 3591 / 187)))


@pytest.mark.parametrize(("inertia", "damping", "ratio"), CORNERS)
def test_every_corner_of_the_motors_stays_finite_into_the_end_stop_and_slack(
    machine, inertia, damping, ratio
):
    made = machine("guide_friction", gear_ratio=ratio)
    made.numbers["rotor_inertia"] = inertia
    made.numbers["rotor_damping"] = damping
    for currents in ((5.0, 0.0), (5.0, 5.0), (-5.0, 5.0), (0.0, 0.0)):
        play(made, currents, 500)
        assert np.rad2deg(np.abs(hinge_angles(made))).max() < 16.0
