"""Every effect, a user's own included, keeps every law."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.effects import replay
from spirob.effects.check import LAWS
from spirob.effects.replay import run
from spirob.plant.check import check_in_model
from tests.effects.effects import EFFECTS, whole

# the library's list; an effect that goes missing must not take its tests with it
LIBRARY = """
    coulomb_friction stribeck_friction presliding_friction quadratic_drag
    asymmetric_viscous_friction load_dependent_friction direction_dependent_efficiency cogging
    torque_ripple torque_constant_saturation winding_heating supply_sag driver_dead_band
    backlash gear_compliance drum_build_up eccentric_winch
    stretch capstan_friction creep
    joint_viscoelasticity stiffness_hardening rest_curvature mount_tilt tip_payload
    current_offset current_gain current_lag feedback_latency encoder_eccentricity
    constant_force parallel_spring
"""


def test_the_library_is_whole():
    assert set(LIBRARY.split()) <= set(EFFECTS)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_keeps_the_law(name, law):
    assert list(LAWS[law](EFFECTS[name])) == []


@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_keeps_the_laws_of_the_model(name):
    effect = EFFECTS[name]
    plant = whole() if effect in whole().effects else None
    assert check_in_model(effect, plant) == []


@pytest.mark.parametrize("name", EFFECTS)
@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_an_effect_is_finite_wherever_it_is_asked(name, data):
    effect = EFFECTS[name]
    about = effect.parameters()
    numbers = {n: data.draw(st.floats(p.low, p.high), n) for n, p in about.items()}
    spans = replay.spans(effect)
    inputs = {a: np.array(data.draw(st.tuples(*[st.floats(*s)] * 3), a)) for a, s in spans.items()}
    dt = data.draw(st.floats(2.5e-4, 1e-3), "dt")
    got, trail = run(effect, numbers, inputs, dt)
    assert all(np.isfinite(values).all() for values in (got, *trail.values()))
