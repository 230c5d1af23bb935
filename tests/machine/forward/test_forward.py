"""The model run forward: an equation with a known solution, and what a controller hides."""

import numpy as np
import pytest

from spirob.effects import find_effects
from spirob.machine.forward import Forward
from spirob.machine.inverse import InverseProblem
from spirob.machine.recording import prepare
from spirob.machine.rig import RigFile
from spirob.machine.scaling import Sizes
from tests.machine.rigs import description

SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")
J, B, W = 0.05, 0.2, 2 * np.pi * 0.6


def swinging(**changes):
    """An axis that swings as sin(wt) under exactly the effort that this takes."""
    t = np.arange(0, 5, 1e-3)
    q = np.sin(W * t)
    u = -J * W**2 * np.sin(W * t) + B * W * np.cos(W * t)
    rig = RigFile.model_validate(description(**changes))
    log = prepare("log", {"t": t, "q": q, "u": u, "r": q}, rig)
    return InverseProblem(rig, None, [log], find_effects(["coulomb_friction"]), SIZES, 0.02)


def test_the_right_numbers_give_the_motion_back():
    right = Forward(swinging()).open_loop({"rig.inertia": J, "rig.viscous": B})
    wrong = Forward(swinging()).open_loop({"rig.inertia": J, "rig.viscous": 2 * B})
    assert right.window == pytest.approx(0, abs=3e-3)
    assert right.whole == pytest.approx(0, abs=2e-2)
    assert wrong.whole > 10 * right.whole


def test_stiff_dry_friction_stops_the_axis_and_stays_finite():
    changes = {"rig.inertia": J, "rig.viscous": B, "coulomb_friction.coulomb_torque": 1.2}
    stuck = Forward(swinging()).open_loop({**changes, "coulomb_friction.softness": 0.05})
    assert np.isfinite(stuck.whole)
    assert stuck.whole > 0.3


def test_a_controller_hides_an_error_in_motion_but_not_in_effort():
    control = {"position": 60.0, "velocity": 8.0}
    reference = {"column": "r", "unit": "rad"}
    made = swinging(predict="closed_loop", control=control, reference=reference)
    right = Forward(made).closed_loop({"rig.inertia": J, "rig.viscous": B})
    wrong = Forward(made).closed_loop({"rig.inertia": J, "rig.viscous": 2 * B})
    assert wrong.whole < 0.05
    assert wrong.effort > 3 * right.effort


def test_without_inertia_there_is_no_motion_to_predict():
    assert "without inertia" in Forward(swinging()).absent({"rig.inertia": 0.0})
    assert Forward(swinging()).absent({"rig.inertia": J}) == ""
