"""The whole box of rotor parameters, at both gear ratios: loaded, slack and in the end stop.

Corners 0.6 and 1 of η, 5e-6 and 5e-4 kg·m² of J_m, 1e-5 and 1e-3 N·m·s/rad of b_m (the paper's
identification box), and points inside it drawn by hypothesis.
"""

import itertools

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spirob.geometry import spiral_arm
from spirob.plant import Plant
from spirob.robot import Scene
from tests.physics.playing import RIGS, currents, rising, seconds

EFFICIENCY, INERTIA, DAMPING = (0.6, 1.0), (5e-6, 5e-4), (1e-5, 1e-3)
CORNERS = list(itertools.product(EFFICIENCY, INERTIA, DAMPING))
PLANTS = {name: Plant(rig) for name, rig in RIGS.items()}
MEET = spiral_arm().unit_angle[0]  # where the guides of a hinge meet
# loaded, let go, snapped taut again, pulled into the end stop
LEFT = np.repeat([1.0, -2.0, 2.0, 5.0], [700, 300, 500, 1000])
RIGHT = np.repeat([0.3, 0.3, -2.0, 0.0], [700, 300, 500, 1000])


def changed(efficiency, inertia, damping):
    return {
        "winch.efficiency": efficiency,
        "motor.rotor_inertia": inertia,
        "motor.rotor_damping": damping,
    }


def endure(ratio, corner):
    """Play the violent schedule; SimulationError is the failure looked for."""
    response = PLANTS[ratio].simulate(currents(LEFT, RIGHT), Scene(), changed(*corner))
    assert np.isfinite(response.angles).all()
    assert np.isfinite(response.arm_current).all()
    assert response.tension.min() == 0.0
    return response


@pytest.mark.parametrize("ratio", RIGS)
@pytest.mark.parametrize("corner", CORNERS)
def test_every_corner_survives_load_slack_and_impact(ratio, corner):
    endure(ratio, corner)


inside = st.tuples(
    st.floats(*EFFICIENCY, exclude_min=True),
    st.floats(*np.log10(INERTIA)).map(lambda x: 10**x),
    st.floats(*np.log10(DAMPING)).map(lambda x: 10**x),
)


@pytest.mark.parametrize("ratio", RIGS)
@given(inside)
@settings(
    max_examples=8,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
def test_the_inside_survives_too(ratio, corner):
    endure(ratio, corner)


# a heavy geared rotor (461 kg at the tendon) bounces on the end stop for a minute
SETTLING = [("geared", (0.6, 5e-6, 1e-5)), ("geared", (0.77, 2e-5, 1e-4))]
SETTLING += [("geared", (1.0, 5e-6, 1e-3)), ("direct", (1.0, 5e-6, 1e-5))]
SETTLING += [("direct", (1.0, 5e-4, 1e-5)), ("direct", (1.0, 5e-4, 1e-3))]


@pytest.mark.parametrize(("ratio", "corner"), SETTLING)
def test_at_rest_in_the_end_stop_everything_balances(ratio, corner):
    rig = RIGS[ratio]
    cycle = np.arange(6000)
    left = 5.0 * np.clip(cycle / 3000, 0.0, 1.0) ** 2
    right = np.where(cycle < 3000, -0.13 * rig.winch.gear_ratio, 0.0)  # pays out, slack
    response = PLANTS[ratio].simulate(currents(left, right), Scene(), changed(*corner))
    late = slice(-100, None)
    tension = response.tension[late, 0]
    stretch = (response.displacement - response.shortening)[late, 0]
    pull = corner[0] * rig.winch.gear_ratio * rig.motor.torque_constant * 5.0 / rig.winch.radius
    assert np.abs(response.shortening_rate[late]).max() < 1e-4
    assert tension == pytest.approx(pull, rel=0.01)
    assert stretch == pytest.approx(tension / rig.tendon.stiffness, rel=0.01)
    assert np.all(response.tension[late, 1] == 0.0)
    assert np.abs(response.angles[late]).max() < MEET
    assert response.angles[late].sum(axis=1).min() > np.radians(680)  # fully curled


# damping with which rotor and arm swing to rest within the trial
@pytest.mark.parametrize(("ratio", "damping"), [("geared", 1e-5), ("direct", 1e-3)])
def test_at_rest_and_free_the_stretch_is_tension_over_stiffness(ratio, damping):
    rig = RIGS[ratio]
    force = 0.4 * rising(seconds(14.0), 3.0)
    ampere = rig.winch.radius / (0.77 * rig.winch.gear_ratio * rig.motor.torque_constant)
    response = PLANTS[ratio].simulate(
        currents(force * ampere, 0.25 * force * ampere), Scene(), changed(0.77, 5e-6, damping)
    )
    late = slice(-100, None)
    stretch = (response.displacement - response.shortening)[late]
    assert np.radians(5) < np.abs(response.angles[late]).max() < 0.9 * MEET  # bent, not stopped
    assert np.abs(response.shortening_rate[late]).max() < 1e-4
    assert response.tension[late] == pytest.approx(np.tile([0.4, 0.1], (100, 1)), rel=0.01)
    assert stretch == pytest.approx(response.tension[late] / rig.tendon.stiffness, rel=0.01)
