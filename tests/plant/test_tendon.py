"""Holes elsewhere than on the drawing."""

import numpy as np
import pytest

from spirob.geometry import spiral_arm
from spirob.plant import Plant
from spirob.plant.rig import Holes
from spirob.plant.tendon import guides, room, shortenings, with_holes
from spirob.robot import Scene
from tests.physics.playing import GEARED, currents

ARM = spiral_arm()


def along(arm):
    """Where the mouths lie on the straight arm, (N, 2) before and after each hinge."""
    origin = np.column_stack([arm.hinge_position, np.zeros(arm.units)])
    return arm.guide_before + origin, arm.guide_after + origin


def test_at_the_drawings_numbers_it_is_the_drawing():
    assert with_holes(ARM, Holes()) is ARM


def test_holes_move_along_the_tendons_straight_line():
    moved = with_holes(ARM, Holes(shift=0.1, mount=0.015))
    (before, after), (drawn_before, drawn_after) = along(moved), along(ARM)
    step = 0.1 * ARM.unit_length
    assert after[:, 0] - drawn_after[:, 0] == pytest.approx(step)
    assert before[1:, 0] - drawn_before[1:, 0] == pytest.approx(step[:-1])  # both mouths of a hole
    assert before[0, 0] - drawn_before[0, 0] == pytest.approx(-0.015)
    every = np.vstack([before, after])
    line = np.polyfit(*every.T, 1)
    assert np.polyval(line, every[:, 0]) == pytest.approx(every[:, 1], abs=1e-12)


def test_height_scales_what_a_bend_shortens():
    angles = np.full(24, 0.01)
    low, drawn = (shortenings(angles, guides(with_holes(ARM, Holes(height=h)))) for h in (0.8, 1.0))
    assert low[0] == pytest.approx(0.8 * drawn[0], rel=0.01)


def test_lengths_are_those_between_the_mouths():
    """Against the mouths themselves, turned about each hinge."""
    arm = with_holes(ARM, Holes(shift=0.12, height=0.95, mount=0.02))
    angles = np.random.default_rng(0).uniform(-0.3, 0.3, 24)
    before, after = (mouths @ [1, 1j] for mouths in (arm.guide_before, arm.guide_after))
    told = [
        np.sum(np.abs(after - before) - np.abs(after * np.exp(1j * side * angles) - before))
        for side in (1.0, -1.0)
    ]
    assert shortenings(angles, guides(arm)) == pytest.approx(told, abs=1e-12)


@pytest.mark.parametrize("number", ["shift", "height", "mount"])
@pytest.mark.parametrize("end", ["low", "high"])
def test_the_model_plays_at_the_bounds(number, end):
    about = Holes.parameters() | {n.partition(".")[2]: a for n, a in room(ARM).items()}
    value = getattr(about[number], end)
    still = currents(np.full(300, 0.3), 0.2)
    found = Plant(GEARED).simulate(still, Scene(), {f"holes.{number}": value})
    assert np.isfinite(found.angles).all()
    assert found.displacement[-1, 0] > 1e-4
