"""The curled arm lies on itself instead of passing through."""

import numpy as np
import pytest

from spirob.emulator.machine import Machine
from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.robot import Scene
from tests.emulator.test_contact import outline

DEEP = 0.5e-3  # m
CYCLES = 2600  # after 1500 the tip meets the base
EVERY = 20  # cycles


def curled(cycles=CYCLES, **numbers):
    """Wound in by the left motor until it lies upon itself.

    The machine, the deepest that units entered by its own account, and by brute force [m].
    """
    made = Machine(EmulatedRig(), HiddenSettings("guide_friction"), seed=1)
    made.start(Scene(), "curl")
    for name, value in numbers.items():
        made.numbers[name] = value
    deepest, seen = 0.0, 0.0
    for k in range(cycles):
        made.cycle((0.8, 0.0))
        deepest = max(deepest, float(made._scratch["turn_depth"][0]))
        if k % EVERY == 0:
            seen = max(seen, overlap(made))
    return made, deepest, seen


def overlap(made):
    """How deep any corner lies within a unit it is not a neighbour of [m], by brute force."""
    points = corners(made)
    deepest = 0.0
    for i, shape in enumerate(points):
        inside = np.full((48, 4), np.inf)
        for a, b in zip(shape, np.roll(shape, -1, axis=0), strict=True):
            along = (b - a) / np.linalg.norm(b - a)
            off = points - a
            inside = np.minimum(inside, along[0] * off[..., 1] - along[1] * off[..., 0])
        far = np.abs(np.arange(48) - i) >= 6
        deepest = max(deepest, float(inside[far].max()))
    return deepest


def corners(made):
    """(48, 4, 2) corners of all units in the world, anticlockwise."""
    phi, length = made.state["phi"][0], made.numbers["length"][0]
    x = np.concatenate([[0.0], np.cumsum(length * np.cos(phi))[:-1]])
    y = np.concatenate([[0.0], np.cumsum(length * np.sin(phi))[:-1]])
    cx, cy = made.numbers["corner_x"][0], made.numbers["corner_y"][0]
    own_x = np.column_stack([cx[:, 0], cx[:, 1], cx[:, 1], cx[:, 0]])
    own_y = np.column_stack([-cy[:, 0], -cy[:, 1], cy[:, 1], cy[:, 0]])
    c, s = np.cos(phi)[:, None], np.sin(phi)[:, None]
    return np.stack(
        [x[:, None] + c * own_x - s * own_y, y[:, None] + s * own_x + c * own_y], axis=-1
    )


@pytest.fixture(scope="module")
def touching():
    return curled()


def test_turns_do_not_enter_each_other(touching):
    _, deepest, seen = touching
    assert 0.0 < deepest < DEEP
    assert seen < DEEP


def test_without_contact_they_would():
    _, _, seen = curled(contact_stiffness=0.0, contact_damping=0.0)
    assert seen > 4 * DEEP


def test_the_brute_force_check_sees_the_same_outline(touching):
    """The corners are those of the outline that the tests of other contacts draw."""
    made = touching[0]
    drawn = outline(made).reshape(-1, 48, 2)
    for point in corners(made)[:, 2]:
        assert np.abs(drawn - point).sum(axis=-1).min() < 1e-12


def test_where_nothing_touches_nothing_changes():
    """Bit by bit: a bend that is half of the curl, with any friction between turns."""
    bends = []
    for friction in (0.0, 5.0):
        made, deepest, _ = curled(cycles=1000, self_friction=friction)
        assert deepest == 0.0
        bends.append(made.state.tobytes())
    assert bends[0] == bends[1]


def test_much_friction_between_turns_holds_the_curl_up():
    ends = [
        float(curled(cycles=1800, self_friction=mu)[0].state["wound"][0, 0]) for mu in (0.0, 2.0)
    ]
    assert ends[1] < 0.95 * ends[0]
