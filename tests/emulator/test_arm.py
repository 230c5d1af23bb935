"""Laws of the passive arm; where turns touch the step is solved as a whole, no inertia is added."""

import numpy as np
import pytest
from scipy.integrate import quad

from spirob.emulator.build import DENSITY, FILL, THICKNESS, anatomy
from spirob.emulator.machine import Machine
from spirob.emulator.physics import arm
from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.geometry import spiral_arm
from spirob.robot import Scene
from tests.emulator.conftest import hinge_angles, loosen, play

CYCLES = 2200  # from 1480 on the tip slides along the base
NEAR = 1e-3  # m
N = 48
BODY = anatomy(spiral_arm(N))


def mass_matrix(machine, phi, body=BODY):
    """Σ m J_cᵀJ_c + I ωωᵀ from the Jacobian of every centre of mass: nothing closed form."""
    length, factor = machine.numbers["length"][0], machine.build.sheet["mass"]
    mass = factor * body.mass
    normal = np.column_stack([-np.sin(phi), np.cos(phi)])
    jacobian = np.tril(np.ones((N, N)), -1)[:, None, :] * (length[:, None] * normal).T
    jacobian[np.arange(N), :, np.arange(N)] = body.centre[:, None] * normal
    weighted = (np.sqrt(mass)[:, None, None] * jacobian).reshape(2 * N, N)
    about_centre = factor * (body.inertia - body.mass * body.centre**2)
    return weighted.T @ weighted + np.diag(about_centre)


def energy(machine, body=BODY):
    phi, rate = machine.state["phi"][0], machine.state["rate"][0]
    kinetic = 0.5 * rate @ mass_matrix(machine, phi, body) @ rate
    return kinetic + 0.5 * machine.numbers["stiffness"][0] @ hinge_angles(machine) ** 2


def disturbed(machine, **rig):
    made = machine(**rig)
    loosen(made)
    rng = np.random.default_rng(0)
    made.state["phi"][0] = np.cumsum(rng.uniform(-0.05, 0.05, N))
    made.state["rate"][0] = np.cumsum(rng.uniform(-0.5, 0.5, N))
    return made


def test_arm_weighs_what_its_volume_says():
    arm = spiral_arm(N)
    unit = 5
    face = np.tan(arm.unit_angle[unit] / 2)
    body = anatomy(arm)
    length = arm.unit_length[unit]
    ratio = arm.scale[0] / arm.scale[1]
    start = arm.half_width[unit] * 2 * ratio / (1 + ratio)

    def slice_mass(x):
        width = start * (1 - x / length * (1 - 1 / ratio))
        height = min(width, x / face, (length - x) / face)
        return DENSITY * FILL * THICKNESS * 2 * width * 2 * height

    expected = quad(slice_mass, 0, length, points=list(body.corner_x[unit]))[0]
    assert body.mass[unit] == pytest.approx(expected, rel=1e-4)
    assert body.mass.sum() == pytest.approx(0.32, abs=0.03)


def test_system_matrix_is_the_mass_matrix_for_a_short_step_and_its_factor_is_exact(machine):
    made = disturbed(machine)
    phi = made.state["phi"][0].copy()
    made.dt = 1e-13
    made._advance(made.numbers, np.zeros(2), steps=1)
    w = made._scratch
    u, v, y = w["u"][0], w["v"][0], w["y"][0]
    system = np.tril(u @ v.T, -1) + np.diag(w["sub"][0, 1:], -1)
    system = system + system.T + np.diag(w["diagonal"][0])
    factor = np.tril(u @ y.T, -1) + np.diag(w["y_sub"][0, :-1], -1) + np.diag(w["pivot"][0])
    np.testing.assert_allclose(factor @ factor.T, system, rtol=1e-9, atol=1e-16)
    expected = mass_matrix(made, phi)
    np.testing.assert_allclose(system, expected, rtol=1e-6, atol=1e-9 * expected.max())


def test_undamped_arm_keeps_its_energy_as_the_step_shrinks(machine):
    lost = []
    for steps in (40, 160):
        made = disturbed(machine, steps_per_cycle=steps)
        made.numbers["damping"] = 0.0
        before = energy(made)
        play(made, (0.0, 0.0), 100)
        lost.append(1 - energy(made) / before)
    assert lost[0] > lost[1] > -1e-3
    assert lost[1] < 0.5 * lost[0]
    assert lost[1] < 0.15


def test_damping_takes_exactly_what_the_energy_loses(machine):
    made = disturbed(machine, steps_per_cycle=100)
    before, dissipated = energy(made), 0.0
    for _ in range(300):
        old = made.state["rate"][0].copy()
        play(made, (0.0, 0.0), 1)
        rates = [np.diff(np.concatenate([[0.0], r])) for r in (old, made.state["rate"][0])]
        powers = [made.numbers["damping"][0] @ r**2 for r in rates]
        dissipated += 0.5e-3 * sum(powers)
    assert before - energy(made) == pytest.approx(dissipated, rel=0.03)


def test_energy_never_grows(machine):
    made = disturbed(machine)
    made.state["rate"][0] *= 20  # whips into the end stops
    made.numbers["damping"] = 0.0
    before = energy(made)
    for _ in range(300):
        play(made, (0.0, 0.0), 1)
        assert energy(made) < 1.01 * before
    assert energy(made) < 0.9 * before


def test_gravity_along_the_arm_hangs_it_straight_and_across_bends_it_statically(machine):
    hanging = machine(gravity=(9.81, 0.0))
    assert np.abs(hanging.state["phi"][0]).max() < 1e-12
    made = machine(gravity=(0.0, -1.0))
    body, arm, phi = anatomy(spiral_arm(N)), spiral_arm(N), made.state["phi"][0]
    ends = np.cumsum(arm.unit_length * np.cos(phi))
    starts = np.concatenate([[0.0], ends[:-1]])
    centres = starts + body.centre * np.cos(phi)
    weight = made.drawn["mass"] * body.mass * 1.0
    for i in (0, 10, 30):
        moment = -weight[i:] @ (centres[i:] - starts[i])
        elastic = made.numbers["stiffness"][0, i] * hinge_angles(made)[i]
        assert elastic == pytest.approx(moment, rel=2e-3)


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
    assert arm.factorise(w)
    arm.write_out(w)
    upper = np.triu(w["whole"])
    return w, upper + upper.T - np.diag(np.diag(upper))


def test_written_out_it_is_the_matrix_that_the_chain_solves(system):
    w, matrix = system
    b = np.random.default_rng(0).normal(size=48)
    x = b.copy()
    arm.solve(w, x)
    assert np.abs(matrix @ x - b).max() < 1e-9


def test_with_blocks_it_is_solved_as_any_symmetric_matrix(system):
    w, matrix = system
    rng = np.random.default_rng(1)
    arm.write_out(w)
    for first, last, weight in ((3, 40, 5e-3), (10, 47, 0.2)):
        lever = np.zeros(48)
        lever[first : last + 1] = rng.normal(scale=0.05, size=last + 1 - first)
        arm.add_block(w, lever, first, last, weight)
        matrix = matrix + weight * np.outer(lever, lever)
    b = rng.normal(size=48)
    x = b.copy()
    assert arm.factorise_whole(w)
    arm.solve_whole(w, x)
    assert np.allclose(x, np.linalg.solve(matrix, b), rtol=1e-8, atol=0.0)


def test_a_matrix_that_is_not_positive_is_refused(system):
    w, _ = system
    arm.write_out(w)
    w["whole"][20, 20] = -1.0
    assert not arm.factorise_whole(w)


def test_touching_turns_slide_alike_at_any_step():
    """With a bounding diagonal, which is an inertia, they were 15 mm apart at this friction."""
    coarse, fine = (bent(steps, CYCLES, self_friction=0.8)[1][:, 0] for steps in (10, 40))
    assert np.abs(coarse - fine).max() < NEAR
