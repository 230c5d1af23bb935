"""The orders of a ripple come back through what a loop makes of its waves."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy import signal

from spirob.diagnosis.orders import answers, best_orders, following
from spirob.effects.motor.cogging import Cogging
from spirob.effects.motor.torque_ripple import TorqueRipple
from spirob.identify.problem import Rotor

SAMPLES, EVERY = 3000, 10
LOOPS = [signal.bessel(2, f, fs=1000.0) for f in (8.0, 3.0)]  # each motor's own, and late
AMPLITUDE = 1e-4


def rotor(seed):
    rng = np.random.default_rng(seed)
    seconds = np.arange(SAMPLES) * 1e-3
    angle = rng.uniform(0, 6) + (40 + 9 * seed) * np.sin(seconds * 0.9) ** 2
    return Rotor(angle, 0.4 + 0.3 * np.sin(seconds), EVERY)


class Machine:
    """Two trials of two motors, one signal, to which waves of torque pass through slow loops."""

    workers = 2

    def __init__(self):
        self.trials = [[rotor(1), rotor(2)], [rotor(3), rotor(4)]]
        self.edges = np.arange(3) * (SAMPLES // EVERY)

    def rotors(self):
        return self.trials

    def filter(self, values):
        return values

    def played(self, waves, by_load):
        """waves  (order, amplitude, phase) of every motor."""
        parts = []
        for trial in self.trials:
            whole = np.zeros(SAMPLES)
            for motor, loop in zip(trial, LOOPS, strict=True):
                torque = sum(a * np.sin(n * motor.angle + p) for n, a, p in waves)
                torque = torque * (motor.effort if by_load else 1.0)
                whole += 50.0 * signal.lfilter(*loop, torque)
            parts.append(whole[::EVERY])
        return np.concatenate(parts)

    def many(self, points):
        """Model minus measurement where a point adds one wave to the model."""
        found = []
        for point in points:
            own = {k.split(".")[1]: v for k, v in point.items()}
            size = float(np.hypot(own["sine"], own["cosine"]))
            phase = float(np.arctan2(own["cosine"], own["sine"]))
            by_load = "torque_ripple.order" in point
            found.append(self.played([(own["order"], size, phase)], by_load))
        return found


def base_of(residual, slopes=None):
    rows = len(residual)
    slopes = np.random.default_rng(5).normal(size=(rows, 3)) if slopes is None else slopes
    return SimpleNamespace(changes={}, residual=residual, jacobian=slopes)


def orders(machine, residual, effect, count=1, slopes=None):
    found = base_of(residual, slopes)
    return best_orders(found, answers(machine, found, effect), count)


def quiet(machine):
    return base_of(np.zeros(machine.edges[-1]))


@pytest.mark.parametrize("effect", [Cogging, TorqueRipple])
@pytest.mark.parametrize("order", [0.2, 0.7, 2.0])
def test_the_answer_to_an_order_that_was_never_played_is_known(effect, order):
    machine, by_load = Machine(), effect is TorqueRipple
    trials = answers(machine, quiet(machine), effect)
    columns = np.concatenate([t.columns(np.array([order])) for t in trials], axis=1)[0]
    seen = machine.played([(order, 1.0, 0.0)], by_load)
    assert np.mean((seen - columns[:, 0] - columns[:, 2]) ** 2) < 0.1 * np.mean(seen**2)


@pytest.mark.parametrize("order", [0.1, 0.28, 1.0, 3.5])
@pytest.mark.parametrize("effect", [Cogging, TorqueRipple])
def test_the_order_comes_back(order, effect):
    machine = Machine()
    residual = machine.played([(order, AMPLITUDE, 0.3)], effect is TorqueRipple)
    noise = np.random.default_rng(0).normal(0, 0.2 * np.std(residual), residual.shape)
    found = orders(machine, residual + noise, effect)
    assert found == [pytest.approx(order, rel=0.06)]


@pytest.mark.parametrize(("one", "two"), [(0.1, 0.41), (1.0, 2.0), (0.28, 2.5)])
def test_a_second_wave_of_its_own_order_comes_back_too(one, two):
    machine = Machine()
    residual = machine.played([(one, 2 * AMPLITUDE, 1.0), (two, AMPLITUDE, 0.0)], False)
    noise = np.random.default_rng(0).normal(0, 0.1 * np.std(residual), residual.shape)
    found = orders(machine, residual + noise, Cogging, 2)
    assert found == [pytest.approx(one, rel=0.1), pytest.approx(two, rel=0.1)]


def test_what_the_fitted_numbers_explain_is_no_ripple():
    machine = Machine()
    seen = machine.played([(2.5, AMPLITUDE, 0.0)], False)
    other = machine.played([(0.28, 0.1 * AMPLITUDE, 0.0)], False)
    found = orders(machine, seen + other, Cogging, slopes=seen[:, None])
    assert found == [pytest.approx(0.28, rel=0.06)]


def test_a_trial_in_which_nothing_is_compared_is_passed_over():
    machine = Machine()
    machine.edges = np.array([0, 0, SAMPLES // EVERY])
    machine.many = lambda points: [np.ones(SAMPLES // EVERY) for _ in points]
    assert len(answers(machine, quiet(machine), Cogging)) == 1


def test_the_answer_to_one_ripple_gives_the_orders_of_another():
    machine = Machine()
    residual = machine.played([(0.6, AMPLITUDE, 0.3)], True)
    base = base_of(residual)
    trials = following(answers(machine, base, Cogging), TorqueRipple)
    assert best_orders(base, trials) == [pytest.approx(0.6, rel=0.06)]


def test_no_order_below_the_least_is_found():
    """A wave slower than the rotor's turn is none of the motor's, however well it would fit."""
    machine = Machine()
    residual = machine.played([(0.28, AMPLITUDE, 0.3), (2.5, 0.2 * AMPLITUDE, 0.0)], True)
    found = base_of(residual)
    played = answers(machine, found, TorqueRipple)
    assert min(best_orders(found, played, 2, least=0.9)) >= 0.9


def test_orders_come_lowest_first():
    machine = Machine()
    residual = machine.played([(2.5, 2 * AMPLITUDE, 1.0), (0.28, AMPLITUDE, 0.0)], False)
    assert orders(machine, residual, Cogging, 2) == [
        pytest.approx(0.28, rel=0.1),
        pytest.approx(2.5, rel=0.1),
    ]
