"""A twin differs from the robot by what the fit leaves open, and by nothing else."""

import numpy as np
import pytest

from pipeline.twins import factors
from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings

NAMED = {
    "arm.base_stiffness": 0.15,
    "arm.damping_time": 0.02,
    "winch.efficiency": 0.7,
    "winch.efficiency_difference": 0.1,
    "capstan_friction.friction": 0.05,
}


def test_the_fitted_numbers_themselves_move_nothing():
    assert all(np.allclose(f, 1.0) for f in factors(NAMED, NAMED).values())


def test_damping_is_a_time_times_stiffness():
    moved = factors(NAMED | {"arm.base_stiffness": 0.3, "arm.damping_time": 0.03}, NAMED)
    assert moved["stiffness"] == pytest.approx([2.0, 2.0])
    assert moved["damping"] == pytest.approx([3.0, 3.0])


def test_a_difference_moves_the_two_motors_apart():
    moved = factors(NAMED | {"winch.efficiency_difference": 0.0}, NAMED)
    assert moved["efficiency"] == pytest.approx([1 / 1.1, 1 / 0.9])


def test_the_robot_takes_the_factors_for_each_motor_and_hinge():
    robot = EmulatedRobot(EmulatedRig(), HiddenSettings("guide_friction", 1.0), seed=1)
    numbers = robot.machine.numbers
    before = {n: np.array(numbers[n][0]) for n in numbers.dtype.names}
    sides = np.array([1.1, 0.9])
    one = {"efficiency": sides, "guide_friction": sides, "stiffness": np.array([1.2, 1.2])}
    robot.machine.move(one)
    robot.close()
    for name, value in before.items():
        own = {"guide_friction": sides[:, None]}.get(name, one.get(name, 1.0))
        own = own if name != "stiffness" else 1.2
        assert np.array(numbers[name][0]) == pytest.approx(value * own), name
