"""The lowest of many valleys is found where slopes lead nowhere, in the deepest bends."""

from types import SimpleNamespace

import numpy as np

from spirob.machine.arm.shape import SHAPE, _deepest, drawn_shape, evolved
from spirob.plant import Plant, Rig

PLACE = np.array([0.62, 0.31, 0.5, 0.77, 0.45])


def rugged(point):
    away = np.linalg.norm(point - PLACE)
    return np.tanh(4.0 * away) + 0.1 * np.sin(60.0 * point).sum() * away


def test_it_comes_near_the_lowest_valley():
    told = []
    found = evolved(rugged, 5, told.append)
    assert np.abs(found - PLACE).max() < 0.1
    assert told


def test_the_same_each_time_and_where_some_costs_cannot_be_told():
    def torn(point):
        return np.inf if point[0] > 0.7 else rugged(point)

    first, second = (evolved(torn, 5, lambda text: None) for _ in range(2))
    np.testing.assert_array_equal(first, second)
    assert first[0] <= 0.7


def test_the_deepest_bend_of_either_motor_is_searched():
    def bend(motor, way):
        wound = np.zeros((5, 2))
        wound[3, motor] = way
        wound[3, 1 - motor] = 1.0  # how far the other one gives is no bend of its own
        return SimpleNamespace(motor=motor, displacement=wound)

    trials = [bend(0, 0.01), bend(1, 0.03), bend(0, 0.02), bend(1, 0.01)]
    train = SimpleNamespace(trials=trials, driven=lambda trial: [trial.motor])
    assert _deepest(train) == [trials[2], trials[1]]


def test_no_shape_that_is_drawn_is_beyond_what_the_model_allows():
    about = Plant(Rig()).table.about
    shape = {n: ends or (about[n].low, about[n].high) for n, ends in SHAPE.items()}
    rng = np.random.default_rng(0)
    for stiffness in (about["arm.base_stiffness"].low, about["arm.base_stiffness"].high):
        for point in rng.random((20, len(shape))):
            found = drawn_shape({"arm.base_stiffness": stiffness}, about, shape, point)
            assert all(about[n].low <= value <= about[n].high for n, value in found.items())
