"""The R-L circuit and the current loop against closed forms."""

import numpy as np
import pytest

from spirob.plant import Plant, Rig
from spirob.plant.motor import current_loop_gains, drive_current
from spirob.plant.rig import Drive, Motor, Winch
from spirob.robot import Scene
from tests.physics.playing import currents

R, L = 0.194, 9.7e-5
OMEGA = 2 * np.pi * 1000.0
K_P, K_I = current_loop_gains(R, L, 1000.0)
FREE = 1e9  # V, a limit that is never met


def drive(current, integral, command, steps, period, **changes):
    """The drive's loop with nominal numbers unless changed."""
    settings = {
        "command_rate": 0.0,
        "misread": 0.0,
        "emf": 0.0,
        "disturbance": 0.0,
        "gain_p": K_P,
        "gain_i": K_I,
        "limit": FREE,
    } | changes
    return drive_current(
        current,
        integral,
        command,
        settings["command_rate"],
        settings["misread"],
        settings["emf"],
        settings["disturbance"],
        steps,
        period,
        R,
        L,
        settings["gain_p"],
        settings["gain_i"],
        0.0,
        settings["limit"],
    )


@pytest.mark.parametrize("period", [1e-5, 1e-3, 1e-2])
def test_a_step_of_voltage_follows_the_closed_form(period):
    # without feedback and with feedforward R·i_cmd the voltage is u = R·i_cmd, a constant
    volts, start, emf = 3.0, 1.2, 0.4
    current, _, mean = drive(start, 0.0, volts / R, 1, period, emf=emf, gain_p=0.0, gain_i=0.0)
    final = (volts - emf) / R
    fading = np.exp(-R * period / L)
    assert current == pytest.approx(final + (start - final) * fading, rel=1e-12)
    t = np.linspace(0.0, period, 20001)
    exact_mean = np.trapezoid(final + (start - final) * np.exp(-R * t / L), t) / period
    assert mean == pytest.approx(exact_mean, rel=1e-6)


def transition(period, **changes):
    """Matrix of one drive sample on (current, integral), by probing the loop at command 0."""
    columns = [drive(*unit, 0.0, 1, period, **changes)[:2] for unit in ((1.0, 0.0), (0.0, 1.0))]
    return np.array(columns).T


def sorted_poles(values):
    return np.array(sorted(values, key=lambda z: (round(z.real, 9), z.imag)))


def test_poles_approach_those_of_the_error_equation():
    # gains off the double pole, where a pole is a smooth function of the step
    gain_p, gain_i = 0.7, 900.0
    exact = sorted_poles(np.roots([L, R + gain_p, gain_i]))
    errors = []
    for period in (2e-6, 1e-6, 5e-7):
        z = np.linalg.eigvals(transition(period, gain_p=gain_p, gain_i=gain_i))
        poles = sorted_poles(np.log(z.astype(complex)) / period)
        errors.append(np.max(np.abs(poles - exact) / np.abs(exact)))
    assert errors[-1] < 0.01
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(2.0, rel=0.05)


@pytest.mark.parametrize("bandwidth", [5.0, 50.0, 100.0])
def test_poles_at_1_khz_are_those_of_the_sampled_loop(bandwidth):
    period = 1e-3
    gain_p, gain_i = current_loop_gains(R, L, bandwidth)
    got = sorted_poles(np.linalg.eigvals(transition(period, gain_p=gain_p, gain_i=gain_i)) + 0j)
    fading = np.exp(-R * period / L)
    gain = (1.0 - fading) / R  # current per held volt, z-transform of hold and circuit
    exact = np.roots(
        [1.0, gain * gain_p - fading - 1.0, fading - gain * gain_p + gain * gain_i * period]
    )
    assert got == pytest.approx(sorted_poles(exact + 0j), rel=1e-9)
    assert np.all(np.abs(got) < 1.0)


def test_a_disturbance_dies_out_with_both_poles_at_the_bandwidth():
    # (L + K_d) ë + (R + K_p) ė + K_i e = ḋ with a step D in d: e = D/L · t·exp(-ω t)
    period, step_volts = 1e-7, 0.5
    current, integral, error = 1.0, 0.0, []
    for _ in range(10000):
        current, integral, _ = drive(current, integral, 1.0, 1, period, disturbance=step_volts)
        error.append(1.0 - current)
    t = period * np.arange(1, 10001)
    exact = step_volts / L * t * np.exp(-OMEGA * t)
    assert np.max(np.abs(error - exact)) < 2e-3 * exact.max()


def test_voltage_stays_within_the_supply():
    current, _, _ = drive(0.0, 0.0, 5.0, 4000, 5e-5, emf=23.5, limit=24.0)
    assert current == pytest.approx((24.0 - 23.5) / R, rel=1e-9)


def test_the_integral_does_not_wind_up():
    # held at the limit for 0.2 s by back-EMF, which then fades within 20 ms
    current, integral, _ = drive(0.0, 0.0, 5.0, 4000, 5e-5, emf=23.5, limit=24.0)
    peak = current
    for emf in np.linspace(23.5, 0.0, 400):
        current, integral, _ = drive(current, integral, 5.0, 1, 5e-5, emf=emf, limit=24.0)
        peak = max(peak, current)
    # all that is left is the error of a steady ḋ, e = ḋ/K_i; an integral that had gone on winding
    # would stand at 1800 V and pin the current at 24 V / R = 124 A
    assert peak == pytest.approx(5.0 + 23.5 / 0.02 / K_I, rel=1e-3)
    assert abs(integral) < 24.0


def test_a_free_rotor_stops_gaining_speed_where_the_supply_ends():
    # slack tendon: k_e ω + R i = U and η k_t i = b_m ω
    motor = Motor(rotor_damping=1e-5)
    rig = Rig(motor=motor, winch=Winch(), drive=Drive())
    response = Plant(rig).simulate(currents(np.full(4000, -2.0), 0.0), Scene())
    gear, radius = rig.winch.gear_ratio, rig.winch.radius
    drag = motor.rotor_damping / (rig.winch.efficiency * motor.torque_constant)
    top = rig.drive.voltage_limit / (motor.emf_constant + motor.resistance * drag)
    assert response.velocity[-1, 0] == pytest.approx(-top * radius / gear, rel=1e-3)
    assert response.tension[-1, 0] == 0.0
