"""A loop's latency, its windings and their back-EMF are found again from what it sent and read."""

import numpy as np
import pytest

from spirob.control import Winding
from spirob.errors import DataError
from spirob.experiments.host_loop import answer, windings
from spirob.plant.motor import held_current
from spirob.plant.rig import Motor

CYCLE = 1e-3
MOTOR = Motor()


def played(tau, shares=(1.0, 1.0), emf=(1.0, 1.0), noise=0.0, seed=0):
    """Currents of two windings whose voltages act `tau` later, stepped one hundredth of a cycle."""
    rng = np.random.default_rng(seed)
    jumps = np.repeat([0.8, 1.2, 0.4, 1.2, 0.4, 1.2], 100)
    volts = 0.194 * np.column_stack([jumps, 1.6 - jumps])
    steps, late = 100, round(100 * tau / CYCLE)
    fine = 20.0 * np.sin(np.arange(600 * steps) * CYCLE / steps * 2 * np.pi * 3)
    current = np.zeros((600, 2))
    for m, share in enumerate(shares):
        now = 0.0
        sent = np.repeat(volts[:, m], steps)
        acts = np.concatenate([np.zeros(late), sent])[: len(sent)]
        for k, u in enumerate(acts):
            if k % steps == 0:
                current[k // steps, m] = now
            now, _ = held_current(
                now, u, u, 0.0, CYCLE / steps, emf[m] * MOTOR.emf_constant * fine[k], 0.0,
                share * MOTOR.resistance, MOTOR.inductance, 24.0,
            )  # fmt: skip
    speed = np.column_stack([fine[::steps]] * 2)
    return current + noise * rng.normal(size=current.shape), volts, speed


@pytest.mark.parametrize("tau", [0.25e-3, 0.7e-3, 1.0e-3, 1.4e-3, 2.6e-3])
def test_all_is_found_again_without_noise(tau):
    found = windings(*played(tau, (1.02, 0.97), (0.99, 1.01)), MOTOR)
    assert found.latency == pytest.approx(tau, abs=1e-5)
    assert found.resistance / MOTOR.resistance == pytest.approx([1.02, 0.97], rel=1e-3)
    assert found.emf_constant / MOTOR.emf_constant == pytest.approx([0.99, 1.01], rel=1e-3)


@pytest.mark.parametrize("tau", [0.7e-3, 1.3e-3])
def test_with_noise_it_lies_within_what_is_told(tau):
    apart = []
    for seed in range(8):
        found = windings(*played(tau, noise=0.005, seed=seed), MOTOR)
        assert 0.0 < found.error < 0.05e-3
        apart.append((found.latency - tau) / found.error)
        assert found.emf_constant / MOTOR.emf_constant == pytest.approx([1.0, 1.0], rel=2e-3)
    assert np.abs(apart).max() < 4.0
    assert np.sqrt(np.mean(np.square(apart))) < 2.0


def test_nothing_acts_before_it_is_sent():
    winding = Winding(MOTOR.resistance, MOTOR.inductance)
    volts = np.zeros(20)
    volts[5] = 1.0
    one = answer(winding, 2.0e-3, volts, np.zeros(20))
    assert np.flatnonzero(one)[0] == 8  # sent in cycle 5, acts in 7, is read in 8


def test_a_current_that_is_held_tells_nothing():
    flat = np.full((500, 2), 0.8)
    with pytest.raises(DataError, match="currents that change"):
        windings(flat, 0.194 * flat, np.full((500, 2), 9.0), MOTOR)


def test_a_rotor_that_stands_tells_no_back_emf():
    current, volts, speed = played(1e-3)
    with pytest.raises(DataError, match="rotors that turn"):
        windings(current, volts, 0.01 * speed, MOTOR)
