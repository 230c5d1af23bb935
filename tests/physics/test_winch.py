"""Rotor, gear and drum with a dead weight, against the closed form; a tendon never pushes."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spirob.effects.winch.constant_force import ConstantForce
from spirob.experiments.host_loop import GainSet
from spirob.experiments.passive import ALUMINIUM, DRUM, DRUM_WIDTH, RADIUS
from spirob.plant import Plant, Rig
from spirob.plant.motor import demanded_tension, free_rate, one_sided_tensions
from spirob.robot import Scene, Weights
from tests.physics.playing import RIGS, currents, rising, seconds

STIFFNESS, DAMPING, STEP, GRAVITY = 4e4, 20.0, 5e-4, 9.81


def rotor(rig):
    """J_eq/r² [kg] and b_eq/r² [N·s/m]."""
    square = (rig.winch.gear_ratio / rig.winch.radius) ** 2
    return square * rig.motor.rotor_inertia, square * rig.motor.rotor_damping


def lift(inertia, damping, weight, force, duration):
    """A weight on the tendon, lifted from rest by a constant force at the drum."""
    stretch = weight * GRAVITY / STIFFNESS  # hanging at rest
    winch = load = 0.0
    rates = []
    for _ in range(round(duration / STEP)):
        free = free_rate(winch, force, inertia, damping, STEP)
        wanted = demanded_tension(stretch, free, load, -GRAVITY, STIFFNESS, DAMPING, STEP)
        give = 1.0 + STEP * DAMPING * (1.0 / (inertia + STEP * damping) + 1.0 / weight)
        tension, _ = one_sided_tensions(wanted, 0.0, give, 0.0, 0.0, 1.0)
        winch = free - STEP * tension / (inertia + STEP * damping)
        load += STEP * (tension / weight - GRAVITY)
        stretch += STEP * (winch - load)
        rates.append((winch, load, tension))
    return np.array(rates)


@pytest.mark.parametrize("rig", RIGS.values(), ids=RIGS)
def test_a_hoisted_weight_follows_the_closed_form(rig):
    inertia, damping = rotor(rig)
    weight = 0.5 * inertia
    force = 1.5 * weight * GRAVITY
    top = (force - weight * GRAVITY) / damping
    lag = (inertia + weight) / damping
    rates = lift(inertia, damping, weight, force, 3 * lag)
    t = STEP * np.arange(1, len(rates) + 1)
    closed = top * (1.0 - np.exp(-t / lag))
    # the weight bounces on its tendon about the closed form; the common motion is compared
    common = (inertia * rates[:, 0] + weight * rates[:, 1]) / (inertia + weight)
    assert np.max(np.abs(common - closed)) < 2e-3 * top
    # the tendon carries the weight and speeds it up
    late = t > 2 * lag
    carried = weight * (GRAVITY + (top - closed[late]) / lag)
    assert np.mean(rates[late, 2]) == pytest.approx(np.mean(carried), rel=2e-3)


@pytest.mark.parametrize("rig", RIGS.values(), ids=RIGS)
def test_a_weight_on_the_drum_follows_the_closed_form_in_the_whole_chain(rig):
    # tendon slack: (m ẇ = η G k_t i/r - m_0 g - b w), the current a step through the R-L circuit
    inertia, damping = rotor(rig)
    amperes, weight = -0.2, 2.0 * rig.gains.newton_per_ampere * 0.1
    plant = Plant(rig, [ConstantForce])
    response = plant.simulate(
        currents(np.full(1500, amperes), amperes), Scene(), {"constant_force.force": -weight}
    )
    drive = rig.winch.efficiency * rig.winch.gear_ratio * rig.motor.torque_constant
    top = (drive * amperes / rig.winch.radius - weight) / damping
    lag = inertia / damping
    t = 1e-3 * np.arange(1500)
    closed = top * (t - lag * (1.0 - np.exp(-t / lag)))
    assert np.all(response.tension == 0.0)
    assert response.displacement[:, 0] == pytest.approx(closed, abs=2e-3 * abs(closed[-1]))
    assert response.displacement[:, 1] == pytest.approx(closed, abs=2e-3 * abs(closed[-1]))


@pytest.mark.parametrize("rig", RIGS.values(), ids=RIGS)
def test_a_known_weight_on_the_drum_follows_the_closed_form_in_the_whole_chain(rig):
    # tendon slack: (m + m_w) ẇ = η G k_t i/r - m_w g - b w, another weight on each side
    inertia, damping = rotor(rig)
    drive = rig.winch.efficiency * rig.winch.gear_ratio * rig.motor.torque_constant
    amperes = -0.3
    pull = drive * amperes / rig.winch.radius
    hung = np.array([0.5, 1.0]) * 0.2 * abs(pull) / GRAVITY
    response = Plant(rig).simulate(
        currents(np.full(1500, amperes), amperes), Scene(weights=Weights(*hung))
    )
    top = (pull - hung * 9.80665) / damping
    lag = (inertia + hung) / damping
    t = 1e-3 * np.arange(1500)[:, None]
    closed = top * (t - lag * (1.0 - np.exp(-t / lag)))
    assert np.all(response.tension == 0.0)
    assert np.abs(response.displacement - closed).max() < 2e-3 * np.abs(closed[-1]).max()


number = st.floats(-100.0, 100.0)
positive = st.floats(0.01, 50.0)


@given(number, number, positive, positive, st.floats(-0.99, 0.99))
def test_tensions_solve_the_one_sided_problem(demand_1, demand_2, yield_1, yield_2, coupling):
    # give = 1 + h c A with A positive definite, as rotor and arm make it
    off = coupling * np.sqrt(yield_1 * yield_2)
    give = np.array([[1.0 + yield_1, off], [off, 1.0 + yield_2]])
    tension = np.array(one_sided_tensions(demand_1, demand_2, *give.ravel()))
    excess = give @ tension - [demand_1, demand_2]
    assert np.all(tension >= 0.0)
    assert np.all(excess >= -1e-9 * (1.0 + np.abs(excess)).max() * np.linalg.cond(give))
    assert abs(tension @ excess) <= 1e-7 * (1.0 + np.abs(tension).max() ** 2)


def test_two_slack_tendons_carry_nothing():
    for demands in itertools.product((-1.0, 0.0), repeat=2):
        assert one_sided_tensions(*demands, 2.0, -0.5, -0.5, 2.0) == (0.0, 0.0)


@pytest.mark.parametrize("rig", RIGS.values(), ids=RIGS)
def test_a_tendon_never_pushes_and_goes_slack_when_paid_out(rig):
    release = np.where(np.arange(1200) < 400, 0.5, -1.0)
    response = Plant(rig).simulate(currents(release, 0.2), Scene())
    stretch = response.displacement[:, 0] - response.shortening[:, 0]
    assert response.tension.min() == 0.0
    assert response.tension[300:400, 0].min() > 0.0
    # slack is a state of its own: the winch runs ahead, the arm follows its own springs
    assert stretch[-1] < -1e-3
    assert np.all(response.tension[stretch < -1e-3, 0] == 0.0)


@pytest.mark.parametrize("rig", RIGS.values(), ids=RIGS)
def test_a_drum_is_inertia_that_the_gear_does_not_multiply(rig):
    t = seconds(0.4)
    schedule = currents(0.5 * rising(t, 0.2), 0.1)
    plant, drum = Plant(rig), 2e-5
    nominal, ratio = rig.motor.rotor_inertia, rig.winch.gear_ratio
    one = plant.simulate(schedule, Scene(), {"winch.drum_inertia": drum})
    same = {"motor.rotor_inertia": nominal + drum / ratio**2}
    other = plant.simulate(schedule, Scene(), same)
    for signal in ("current", "arm_current", "displacement", "tension"):
        assert getattr(one, signal) == pytest.approx(getattr(other, signal), abs=1e-9)
    without = plant.simulate(schedule, Scene())
    assert np.abs(one.displacement - without.displacement).max() > 1e-9


def test_the_drum_of_the_drawing_is_a_solid_cylinder():
    r = (np.arange(20000) + 0.5) / 20000 * RADIUS
    rings = 2 * np.pi * r * DRUM_WIDTH * ALUMINIUM * r**2 * RADIUS / 20000
    assert pytest.approx(rings.sum(), rel=1e-6) == DRUM
    assert Rig.from_mapping(GainSet(5.0, 0.0, 1e-3).rig()).winch.drum_inertia == DRUM
