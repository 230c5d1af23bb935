"""Voltage mode: the winding in closed form, voltages that come when the bus has brought them."""

import can
import numpy as np
import pytest

from spirob.can_protocol import VOLTAGE_FEEDBACK_ID, VOLTAGE_ID, encode_volts
from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings
from spirob.emulator.machine import CYCLE, JITTER, MEAN, BusLatency
from spirob.robot import Scene


class At:
    """A bus that brings voltages at moments of its own, in the order sent."""

    def __init__(self, *moments):
        self.moments = moments

    def begin(self, trial):
        """Nothing is drawn."""

    def arrivals(self, volts):
        """All of them, each twice the one before."""
        return [(at, tuple(v * 2**k for v in volts)) for k, at in enumerate(self.moments)]


def standing(machine, *moments):
    """A machine whose rotors cannot move within a millisecond."""
    made = machine(by_voltage=True)
    made.numbers["rotor_inertia"] = made.numbers["winch_inertia"] = 1e6
    made.latency = At(*moments)
    return made


@pytest.mark.parametrize("moments", [(0.0,), (0.31e-3,), (0.7e-3,), (0.2e-3, 0.2e-3), (1e-4, 9e-4)])
def test_the_winding_follows_the_closed_form_whenever_voltages_come(machine, moments):
    made = standing(machine, *moments)
    p, current, volts = made.numbers, np.zeros(2), np.zeros(2)
    for told in ((0.4, -0.2), (0.9, 0.1), (-0.3, 0.0)):
        made.cycle(told)
        at = 0.0
        for k, until in enumerate((*moments, CYCLE)):
            settled = volts / p["resistance"][0]
            left = np.exp(-p["resistance"][0] * (until - at) / p["inductance"][0])
            current, at = settled + (current - settled) * left, until
            volts = np.array(told) * 2**k if k < len(moments) else volts
        assert made.state["current"][0] == pytest.approx(current, rel=1e-4, abs=1e-6)
        assert made.counts[:, 2] == pytest.approx(current / (20 / 16384), abs=0.6)


def test_the_supply_limits_what_is_held(machine):
    made = standing(machine, 0.0)
    made.numbers["supply"] = 1.0
    for _ in range(10):
        made.cycle((20.0, -20.0))
    most = 1.0 / made.numbers["resistance"][0]
    assert made.state["current"][0] == pytest.approx([most[0], -most[1]], rel=1e-3)


def test_energy_of_the_windings(machine):
    # ∫ u i dt = ∫ R i² dt + L i²/2, with the rotors standing and the winding cold
    made = standing(machine, 0.0)
    resistance, inductance = made.numbers["resistance"][0, 0], made.numbers["inductance"][0, 0]
    put, lost, fine, before = 0.0, 0.0, 50, 0.0
    for k in range(40):
        u = 0.5 * np.sin(0.3 * k)
        made.cycle((u, 0.0))
        t = np.linspace(0.0, CYCLE, fine + 1)
        settled = u / resistance
        i = settled + (before - settled) * np.exp(-resistance * t / inductance)
        put += np.trapezoid(u * i, t)
        lost += np.trapezoid(resistance * i**2, t)
        before = made.state["current"][0, 0]
    stored = 0.5 * inductance * before**2
    assert put == pytest.approx(lost + stored, rel=2e-3)


def test_voltages_come_about_a_cycle_after_their_reading_and_in_order():
    bus = BusLatency(np.random.default_rng(1))
    bus.begin(np.random.default_rng(2))
    assert MEAN[0] <= bus.mean <= MEAN[1]
    seen = []
    for k in range(3000):
        for at, volts in bus.arrivals((float(k), 0.0)):
            assert 0.0 <= at < CYCLE
            seen.append((k * CYCLE + at - volts[0] * CYCLE, volts[0]))
    late = np.array([s[0] for s in seen])
    assert [s[1] for s in seen] == list(range(len(seen)))
    assert np.abs(late - bus.mean).max() <= JITTER + 1e-12
    assert np.ptp(late) > JITTER


def voltage_robot(seed=3):
    return EmulatedRobot(EmulatedRig(by_voltage=True), HiddenSettings("none"), seed)


def test_frames_are_those_of_the_drive_and_trials_repeat():
    robot = voltage_robot()
    played = []
    for _ in range(2):
        robot.prepare(Scene(), "again")
        frames = [f for k in range(30) for f in robot.exchange(encode_volts((0.1 * (k % 5), 0.2)))]
        played.append(frames)
    assert played[0] == played[1]
    assert {f.arbitration_id for f in played[0]} == {
        VOLTAGE_ID,
        *(VOLTAGE_FEEDBACK_ID + np.r_[1, 2]),
    }
    assert 0.6e-3 < robot.truth()["bus_latency"] < 1.4e-3
    robot.close()


def test_a_drive_that_hears_nothing_goes_to_zero_volts():
    robot = voltage_robot()
    robot.prepare(Scene())
    robot.exchange(encode_volts((0.3, 0.3)))
    for _ in range(9):
        robot.node.cycle(silent=True)
    assert robot.machine.state["volts"][0] == pytest.approx([0.3, 0.3], abs=1e-3)
    for _ in range(4):
        robot.node.cycle(silent=True)
    assert not robot.machine.state["volts"].any()
    robot.close()


def test_currents_are_not_heard_in_voltage_mode():
    robot = voltage_robot()
    robot.prepare(Scene())
    robot._bus.send(can.Message(arbitration_id=0x200, is_extended_id=False, data=b"\x10" * 8))
    for _ in range(5):
        robot.node.cycle(silent=True)
    assert not robot.machine.state["volts"].any()
    robot.close()


def test_faults_act_on_the_frames_of_voltage_mode():
    settings = [{"kind": "lost", "probability": 1.0, "start": 0.0}]
    robot = EmulatedRobot(EmulatedRig(by_voltage=True), HiddenSettings("none"), 3, settings)
    robot.prepare(Scene())
    assert [f.arbitration_id for f in robot.exchange(encode_volts((0.0, 0.0)))] == [VOLTAGE_ID]
    robot.close()
