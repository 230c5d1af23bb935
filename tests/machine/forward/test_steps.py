"""The compiled steps against equations with known solutions: order, rest, and a bristle."""

import numpy as np
import pytest

from spirob.effects import find_effects
from spirob.machine.forward import torque
from spirob.machine.forward.torque import AT, OWN, memory_of

NONE = (0.0,) * 9


def played(h, seconds, own, at=(0.0, 0.0), effort=np.zeros_like, effects=(), numbers=()):
    """Time, and position, speed and effort of an axis from a state."""
    found = find_effects(list(effects))
    t = np.arange(round(seconds / h) + 1) * h
    out, motion = np.empty((3, len(t))), np.zeros((6, len(t)))
    motion[0], motion[1], motion[2] = t, *at
    cells = {"INERTIA": 0.05, "VISCOUS": 0.0, "STIFFNESS": 0.0, "SCALE": 1.0, "REST": 0.02}
    cells |= {"ANGLE": 1.0, **own}
    torque.loop_of(found)(
        out,
        np.array([[0, 0, len(t)]]),
        np.array([h]),
        motion,
        effort(t),
        np.array(NONE),
        np.array([cells.get(x, 0.0) for x in OWN]),
        np.array(numbers, float),
        np.array(memory_of(found)),
        np.zeros((1, 0, len(AT))),
        np.ones(2),
    )
    return t, out


@pytest.mark.parametrize(("effects", "numbers"), [((), ()), (("quadratic_drag",), (0.05,))])
def test_the_error_falls_with_the_square_of_the_step(effects, numbers):
    own = {"VISCOUS": 0.2, "STIFFNESS": 1.3}

    def end(h):
        return played(h, 0.8, own, (1.0, 0.5), lambda t: np.sin(5 * t), effects, numbers)[1][0, -1]

    exact = end(1e-5)
    errors = [abs(end(h) - exact) for h in (1e-3, 5e-4, 2.5e-4)]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.05)


def test_a_slow_log_is_divided_into_short_steps():
    own = {"VISCOUS": 0.2, "STIFFNESS": 1.3}
    fine, coarse = played(1e-3, 1.0, own, (1.0, 0.5))[1], played(1e-2, 1.0, own, (1.0, 0.5))[1]
    np.testing.assert_allclose(coarse[0], fine[0, ::10], atol=1e-12)


def test_a_spring_keeps_its_energy():
    """Verlet's energy swings by (h·w)²/8 of itself, and stays: here 3e-6 over 80 periods."""
    _, (q, v, _) = played(1e-3, 100.0, {"STIFFNESS": 1.3}, (1.0, 0.0))
    energy = 0.5 * 0.05 * v**2 + 0.5 * 1.3 * q**2
    np.testing.assert_allclose(energy, energy[0], rtol=1e-5)


def test_the_work_of_the_effort_is_what_friction_and_motion_have_of_it():
    t, (q, v, e) = played(
        5e-4, 5.0, {"VISCOUS": 0.2, "STIFFNESS": 1.3}, (0.5, 0.0), lambda t: np.sin(7 * t)
    )
    energy = 0.5 * 0.05 * v**2 + 0.5 * 1.3 * q**2
    work = np.trapezoid((e - 0.2 * v) * v, t)
    assert energy[-1] - energy[0] == pytest.approx(work, abs=1e-4 * np.trapezoid(np.abs(e * v), t))


@pytest.mark.parametrize("h", [1e-3, 1e-2])
def test_dry_friction_stops_the_axis_after_the_way_that_its_energy_lasts(h):
    """½·J·v² = F·s, and then rest without chatter, though a step could stop it many times over."""
    _, (q, v, _) = played(h, 1.0, {}, (0.0, 1.0), effects=["coulomb_friction"], numbers=(1.0, 1.0))
    assert q[-1] == pytest.approx(0.5 * 0.05, abs=1e-4)
    assert np.all(np.abs(v[-5:]) < 1e-9)


def test_stiff_viscous_friction_is_exact():
    """Forty times the reciprocal of the step: the speed is the effort's from the first row on."""
    own = {"INERTIA": 1e-5, "VISCOUS": 0.4}
    _, (_, v, _) = played(1e-3, 0.1, own, effort=lambda t: np.full_like(t, 0.8))
    np.testing.assert_allclose(v[1:], 2.0, rtol=1e-9)
