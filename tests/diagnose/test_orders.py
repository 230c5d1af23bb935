"""The order of a ripple comes back from a residual over the rotor's angle."""

from types import SimpleNamespace

import numpy as np
import pytest

from spirob.diagnose.orders import best_orders
from spirob.identify.problem import Stretch

SAMPLES = 800


def stretch(channel, seed):
    rng = np.random.default_rng(seed)
    seconds = np.arange(SAMPLES) * 0.01
    angle = rng.uniform(0, 6) + 40 * np.sin(seconds * 0.8) ** 2
    effort = 0.4 + 0.3 * np.sin(seconds)
    flat = np.zeros(SAMPLES)
    return Stretch("t", channel, seconds, flat, flat, effort, 1e-3, "in", "out", angle)


def problem(angle_known=True):
    pieces = [stretch("left", 1), stretch("right", 2)]
    if not angle_known:
        pieces = [Stretch(*list(vars(p).values())[:-1]) for p in pieces]
    rows = np.ones(2 * SAMPLES, dtype=bool)
    return SimpleNamespace(
        stretches=lambda: pieces,
        rows=rows,
        raw=lambda: [p.effort for p in pieces],
        filter=lambda values: values,
    ), pieces


@pytest.mark.parametrize("order", [0.1, 0.28, 1.0, 3.5])
@pytest.mark.parametrize("by_load", [False, True])
def test_the_order_comes_back(order, by_load):
    case, pieces = problem()
    phases = (0.3, 2.0)  # each motor has its own
    waves = [
        np.sin(order * p.angle + phase) * (p.effort if by_load else 1.0)
        for p, phase in zip(pieces, phases, strict=True)
    ]
    residual = 0.01 * np.concatenate(waves)
    residual += np.random.default_rng(0).normal(0, 0.003, residual.shape)
    slopes = np.random.default_rng(5).normal(size=(2 * SAMPLES, 3))
    assert best_orders(case, residual, slopes, by_load) == [pytest.approx(order, rel=0.06)]


@pytest.mark.parametrize(("one", "two"), [(0.1, 0.41), (1.0, 2.0), (0.28, 7.0)])
def test_a_second_wave_of_its_own_order_comes_back_too(one, two):
    case, pieces = problem()
    waves = [2 * np.sin(one * p.angle + 1) + np.sin(two * p.angle) for p in pieces]
    residual = 0.01 * np.concatenate(waves)
    residual += np.random.default_rng(0).normal(0, 0.003, residual.shape)
    found = best_orders(case, residual, np.ones((2 * SAMPLES, 1)), False, 2)
    assert found == [pytest.approx(one, rel=0.1), pytest.approx(two, rel=0.1)]


def test_what_the_fitted_numbers_explain_is_no_ripple():
    case, pieces = problem()
    seen = np.concatenate([np.sin(3.5 * p.angle) for p in pieces])
    other = np.concatenate([np.sin(0.28 * p.angle) for p in pieces])
    found = best_orders(case, seen + 0.1 * other, seen[:, None], by_load=False)
    assert found == [pytest.approx(0.28, rel=0.06)]


def test_without_an_angle_there_is_no_order():
    case, _ = problem(angle_known=False)
    assert best_orders(case, np.ones(2 * SAMPLES), np.ones((2 * SAMPLES, 1)), False) == []
