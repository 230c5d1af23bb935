"""The model with its current loop on the host: winding in closed form, current at its command."""

import dis

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.can_protocol import VOLT_PER_COUNT
from spirob.control import HostLoop, Winding, host_voltage
from spirob.plant import Plant, Rig, assemble
from spirob.plant.motor import held_current
from spirob.plant.rig import Drive, Motor, Winch
from spirob.robot import Scene
from tests.physics.playing import DIRECT, currents

R, L = 0.194, 9.7e-5


@settings(max_examples=60, deadline=None)
@given(
    st.floats(-5.0, 5.0),
    st.floats(-3.0, 3.0),
    st.floats(-3.0, 3.0),
    st.floats(0.0, 1.0),
    st.floats(-1.0, 1.0),
)
def test_a_held_voltage_follows_the_closed_form(start, before, after, share, emf):
    period = 1e-3
    late = share * period
    end, mean = held_current(start, before, after, late, period, emf, 0.1, R, L, 24.0)
    t = np.linspace(0.0, period, 20001)

    def closed(first, volts, passed):
        final = (volts - emf - 0.1) / R
        return final + (first - final) * np.exp(-R * passed / L)

    switched = closed(start, before, late)
    exact = np.where(t <= late, closed(start, before, t), closed(switched, after, t - late))
    assert end == pytest.approx(exact[-1], abs=1e-9)
    assert mean == pytest.approx(np.trapezoid(exact, t) / period, abs=1e-4)


def test_the_supply_limits_both_voltages():
    end, _ = held_current(0.0, 99.0, -99.0, 0.5, 1.0, 0.0, 0.0, R, L, 24.0)
    assert end == pytest.approx(-24.0 / R)


def test_the_integral_does_not_wind_up():
    # at the limit, with an error that would drive it further, it stands still
    asked = (5.0, 5.0, 0.0, 5.0, 0.0, 7.0, 1e-3, R, L, 0.0203, 0.05, 40.0, 0.0, 2.0)
    assert host_voltage(*asked)[:2] == (2.0, 7.0)
    asked = (0.0, 0.0, 5.0, 0.0, 0.0, 7.0, 1e-3, R, L, 0.0203, 0.05, 40.0, 0.0, 2.0)
    assert host_voltage(*asked)[1] == pytest.approx(7.0 - 40.0 * 5.0 * 1e-3)


def held_rotor(latency, bandwidth):
    """A rig whose rotors cannot move within a trial, so that (14) holds exactly."""
    motor = Motor(rotor_inertia=5e-4, rotor_damping=1e-3)
    host = HostLoop(latency=latency, bandwidth=bandwidth)
    return Rig(motor=motor, winch=Winch(gear_ratio=200.0), host=host)


@pytest.mark.parametrize(("latency", "bandwidth"), [(0.0, 20.0), (0.6e-3, 50.0), (1.3e-3, 30.0)])
def test_the_model_is_the_sampled_loop_to_the_last_cycle(latency, bandwidth):
    rig = held_rotor(latency, bandwidth)
    cycles = 60
    played = Plant(rig).simulate(currents(np.full(cycles, 0.02), 0.0), Scene())
    assert np.abs(played.velocity).max() < 1e-4
    winding = Winding(R, L)
    whole, first, second = winding.answer(latency)
    volts, current, integral, error, last = [0.0, 0.0, 0.0], 0.0, 0.0, None, 0.0
    for k in range(cycles):
        assert played.current[k, 0] == pytest.approx(current, abs=2e-4)
        current = played.current[k, 0]
        error = 0.02 - current if error is None else error
        speed = played.velocity[k, 0] * 200.0 / 0.02
        gains = rig.placed().gains
        u, integral, error = host_voltage(
            0.02, last, current, error, speed, integral, 1e-3, R, L, 0.0203, *gains, 24.0
        )
        last = 0.02
        sent = played.voltage[k, 0]  # in counts of the bus
        assert sent / VOLT_PER_COUNT == pytest.approx(round(sent / VOLT_PER_COUNT), abs=1e-9)
        assert abs(sent - u) <= 0.5001 * VOLT_PER_COUNT
        volts = [sent, *volts[:2]]
        current = winding.decay * current + first * volts[whole] + second * volts[whole + 1]
        current -= (1 - winding.decay) / R * 0.0203 * speed


def test_current_comes_to_its_command_and_voltage_to_what_it_takes():
    rig = Rig(winch=DIRECT.winch, gains=DIRECT.gains, host=HostLoop(bandwidth=20.0))
    played = Plant(rig).simulate(currents(np.full(1500, 0.8), 0.8), Scene())
    # a count of the voltage is 5 mA, so that the loop goes to and fro between two of them
    current, speed = played.current[-400:].mean(axis=0), played.velocity[-400:].mean(axis=0)
    assert current == pytest.approx([0.8, 0.8], abs=1e-3)
    assert np.abs(played.current[-400:] - 0.8).max() < VOLT_PER_COUNT / R
    emf = rig.motor.emf_constant * speed / rig.winch.radius
    assert played.voltage[-400:].mean(axis=0) == pytest.approx(R * current + emf, abs=2e-4)


def test_pieces_and_mirror():
    rig = Rig(winch=DIRECT.winch, gains=DIRECT.gains, host=HostLoop(bandwidth=20.0))
    t = np.arange(300) * 1e-3
    asked = currents(0.5 + 0.3 * np.sin(20 * t), 0.4)
    whole = Plant(rig).simulate(asked, Scene())
    session = Plant(rig).start(Scene())
    parts = [session.play(currents(0.5 + 0.3 * np.sin(20 * s), 0.4)) for s in (t[:123], t[123:])]
    pieces = np.concatenate([part.voltage[:-1] for part in parts])
    assert np.array_equal(pieces, whole.voltage)
    mirrored = currents(0.4 * np.ones(300), 0.5 + 0.3 * np.sin(20 * t))
    other = Plant(rig).simulate(mirrored, Scene())
    assert other.current[:, ::-1] == pytest.approx(whole.current, abs=1e-9)


def test_a_loop_in_the_drive_is_compiled_without_any_of_it():
    code = compile(assemble.generate([]), "loop", "exec")
    functions = [c for c in code.co_consts if hasattr(c, "co_name")]
    used = {one.argval for f in functions for one in dis.get_instructions(f)}
    assert "drive_current" in used
    host = {"host_voltage", "held_current", "counted", "noise", "volts", "switch", "whole"}
    assert not host & used
    assert not np.any(Plant(Rig()).simulate(currents(np.full(20, 0.5), 0.5), Scene()).voltage)


def test_a_faster_loop_lets_a_push_move_the_current_less():
    found = []
    for bandwidth in (5.0, 20.0, 80.0):
        rig = Rig(
            winch=DIRECT.winch,
            drive=Drive(emf_compensation=0.0),
            host=HostLoop(bandwidth=bandwidth),
        )
        played = Plant(rig).simulate(currents(np.full(400, 0.3), 0.8), Scene())
        found.append(np.abs(played.current[100:, 0] - 0.3).max())
    assert found[0] > found[1] > found[2]
