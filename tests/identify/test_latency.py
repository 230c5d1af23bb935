"""A loop's latency is found again from currents and voltages, its resistance with it."""

import numpy as np
import pytest

from spirob.control.host_loop import Winding
from spirob.errors import DataError
from spirob.identify.latency import answer, latency
from spirob.plant.motor import held_current
from spirob.plant.rig import Motor

CYCLE = 1e-3
MOTOR = Motor()


def played(tau, shares=(1.0, 1.0), noise=0.0, seed=0):
    """Currents of two windings whose voltages act `tau` later, stepped one hundredth of a cycle."""
    rng = np.random.default_rng(seed)
    ramp = np.minimum(np.arange(600) * CYCLE / 0.05, 1.0)
    volts = 0.194 * 0.8 * np.column_stack([ramp, 0.8 * ramp])
    speed = 20.0 * np.sin(np.arange(600) * CYCLE * 2 * np.pi * 3)[:, None] * np.ones(2)
    current = np.zeros((600, 2))
    steps, late = 100, round(100 * tau / CYCLE)
    for m, share in enumerate(shares):
        now = 0.0
        sent = np.repeat(volts[:, m], steps)
        acts = np.concatenate([np.zeros(late), sent])[: len(sent)]
        for k in range(600):
            current[k, m] = now
            for u in acts[k * steps : (k + 1) * steps]:
                emf = MOTOR.emf_constant * speed[k, m]
                now, _ = held_current(
                    now, u, u, 0.0, CYCLE / steps, emf, 0.0,
                    share * MOTOR.resistance, MOTOR.inductance, 24.0,
                )  # fmt: skip
    return current + noise * rng.normal(size=current.shape), volts, speed


@pytest.mark.parametrize("tau", [0.25e-3, 0.7e-3, 1.0e-3, 1.4e-3, 2.6e-3])
def test_it_is_found_again_without_noise(tau):
    found = latency(*played(tau, (1.02, 0.97)), MOTOR)
    assert found.seconds == pytest.approx(tau, abs=2e-6)
    assert found.resistance / MOTOR.resistance == pytest.approx([1.02, 0.97], rel=1e-4)


@pytest.mark.parametrize("tau", [0.7e-3, 1.3e-3])
def test_with_noise_it_lies_within_what_is_told(tau):
    apart = []
    for seed in range(8):
        found = latency(*played(tau, noise=0.005, seed=seed), MOTOR)
        assert 0.0 < found.error < 0.2e-3
        apart.append((found.seconds - tau) / found.error)
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
        latency(flat, 0.194 * flat, np.zeros((500, 2)), MOTOR)
