"""Laws of contact with a cylinder."""

import numpy as np
import pytest

from spirob.errors import ConfigError
from spirob.geometry import spiral_arm
from spirob.robot import Cylinder, Scene
from tests.emulator.conftest import hinge_angles

DEEP = 0.7e-3  # m


def wrapped(machine, cylinder, current=0.8, cycles=4000):
    made = machine()
    made.start(Scene(cylinder), "wrap")
    deepest = 0.0
    for _ in range(cycles):
        made.cycle((current, 0.02))
        deepest = max(deepest, made._scratch["depth"][0])
    return made, deepest


def outline(made):
    """Points along every unit's outline, both sides, in the world."""
    arm = spiral_arm(48)
    x, y = np.zeros(48), np.zeros(48)
    phi = made.state["phi"][0]
    x[1:] = np.cumsum(arm.unit_length * np.cos(phi))[:-1]
    y[1:] = np.cumsum(arm.unit_length * np.sin(phi))[:-1]
    cx, cy = made.numbers["corner_x"][0], made.numbers["corner_y"][0]
    points = []
    for t in np.linspace(0, 1, 20):
        for side in (1, -1):
            px = cx[:, 0] + t * (cx[:, 1] - cx[:, 0])
            py = side * (cy[:, 0] + t * (cy[:, 1] - cy[:, 0]))
            points.append(
                np.column_stack(
                    [
                        x + np.cos(phi) * px - np.sin(phi) * py,
                        y + np.sin(phi) * px + np.cos(phi) * py,
                    ]
                )
            )
    return np.concatenate(points)


@pytest.mark.parametrize("diameter", [0.02, 0.04, 0.07])
def test_arm_wraps_round_a_cylinder_without_entering_it(machine, diameter):
    cylinder = Cylinder(diameter, x=0.25, y=0.04 + diameter / 2)
    made, deepest = wrapped(machine, cylinder)
    free, _ = wrapped(machine, None)
    distance = np.linalg.norm(outline(made) - [cylinder.x, cylinder.y], axis=1)
    assert deepest < DEEP
    assert distance.min() > diameter / 2 - DEEP
    assert distance.min() < diameter / 2 + 1e-3
    assert np.abs(hinge_angles(made) - hinge_angles(free)).max() > 0.05


def test_a_cylinder_out_of_reach_changes_nothing(machine):
    near, _ = wrapped(machine, Cylinder(0.04, x=-0.5, y=0.5), cycles=300)
    none, _ = wrapped(machine, None, cycles=300)
    assert np.array_equal(near.state["phi"], none.state["phi"])


def test_friction_with_the_cylinder_dissipates(machine):
    cylinders = [Cylinder(0.04, 0.25, 0.06, friction) for friction in (0.0, 0.6)]
    smooth, rough = (wrapped(machine, c)[0].state["wound"][0, 0] for c in cylinders)
    assert rough < smooth - 1e-4


def test_a_cylinder_inside_the_resting_arm_is_refused(machine):
    with pytest.raises(ConfigError, match="overlaps the resting arm"):
        machine().start(Scene(Cylinder(0.04, x=0.2, y=0.0)), "bad")
