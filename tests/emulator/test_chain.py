"""Where turns touch the step is solved as a whole, and adds no inertia of its own."""

import numpy as np
import pytest

from spirob.emulator.machine import Machine
from spirob.emulator.physics import chain
from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.robot import Scene

CYCLES = 2200  # from 1480 on the tip slides along the base
NEAR = 1e-3  # m


def bent(steps=10, cycles=900, **numbers):
    """Wound in by the left motor: the machine, and the lengths after each cycle [m]."""
    made = Machine(EmulatedRig(steps_per_cycle=steps), HiddenSettings("guide_friction"), seed=1)
    made.start(Scene(), "curl")
    for name, value in numbers.items():
        made.numbers[name] = value
    wound = []
    for _ in range(cycles):
        made.cycle((0.8, 0.0))
        wound.append(made.state["wound"][0].copy())
    return made, np.array(wound)


@pytest.fixture(scope="module")
def system():
    """Scratch of a bent arm with the matrix of its last step, and that matrix written out."""
    w = bent()[0]._scratch[0]
    assert chain.factorise(w)
    chain.write_out(w)
    upper = np.triu(w["whole"])
    return w, upper + upper.T - np.diag(np.diag(upper))


def test_written_out_it_is_the_matrix_that_the_chain_solves(system):
    w, matrix = system
    b = np.random.default_rng(0).normal(size=48)
    x = b.copy()
    chain.solve(w, x)
    assert np.abs(matrix @ x - b).max() < 1e-9


def test_with_blocks_it_is_solved_as_any_symmetric_matrix(system):
    w, matrix = system
    rng = np.random.default_rng(1)
    chain.write_out(w)
    for first, last, weight in ((3, 40, 5e-3), (10, 47, 0.2)):
        lever = np.zeros(48)
        lever[first : last + 1] = rng.normal(scale=0.05, size=last + 1 - first)
        chain.add_block(w, lever, first, last, weight)
        matrix = matrix + weight * np.outer(lever, lever)
    b = rng.normal(size=48)
    x = b.copy()
    assert chain.factorise_whole(w)
    chain.solve_whole(w, x)
    assert np.allclose(x, np.linalg.solve(matrix, b), rtol=1e-8, atol=0.0)


def test_a_matrix_that_is_not_positive_is_refused(system):
    w, _ = system
    chain.write_out(w)
    w["whole"][20, 20] = -1.0
    assert not chain.factorise_whole(w)


def test_touching_turns_slide_alike_at_any_step():
    """With a bounding diagonal, which is an inertia, they were 15 mm apart at this friction."""
    coarse, fine = (bent(steps, CYCLES, self_friction=0.8)[1][:, 0] for steps in (10, 40))
    assert np.abs(coarse - fine).max() < NEAR
