"""What is said of a model run forward: errors, what a controller hides, and guesses beside them."""

import numpy as np
import pytest

from spirob.effects import find_effects
from spirob.machine.description.rig import RigFile
from spirob.machine.forward import Forward
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import Sizes
from spirob.machine.recordings.recording import prepare
from tests.machine.rigs import description

SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")
J, B, W = 0.05, 0.2, 2 * np.pi * 0.6
RIGHT, WRONG = {"rig.inertia": J, "rig.viscous": B}, {"rig.inertia": J, "rig.viscous": 2 * B}


def swinging(logs=1, **changes):
    """An axis that swings as sin(wt) under exactly the effort that this takes."""
    t = np.arange(0, 5, 1e-3)
    q = np.sin(W * t)
    u = -J * W**2 * np.sin(W * t) + B * W * np.cos(W * t)
    rig = RigFile.model_validate(description(**changes))
    made = [prepare(f"log {k}", {"t": t, "q": q, "u": u, "r": q}, rig) for k in range(logs)]
    return InverseProblem(rig, None, made, find_effects(["coulomb_friction"]), SIZES, 0.02)


def errors(changes, made=None):
    forward = Forward(made or swinging())
    return forward.errors(changes, forward.predicted(changes))


def test_the_right_numbers_give_the_motion_back():
    right, wrong = errors(RIGHT), errors(WRONG)
    for span in ("window", "whole"):
        assert right[span]["position"]["rmse"] < 1e-4
        assert right[span]["speed"]["rmse"] < 1e-3
        for quantity in ("position", "speed"):
            assert wrong[span][quantity]["rmse"] > 100 * right[span][quantity]["rmse"]
    assert right["effort"] is None


def test_stiff_dry_friction_stops_the_axis_and_stays_finite():
    numbers = {"coulomb_friction.coulomb_torque": 1.2, "coulomb_friction.softness": 0.05}
    stuck = errors(RIGHT | numbers)["whole"]["position"]["rmse"]
    assert np.isfinite(stuck)
    assert stuck > 0.3


def test_a_controller_hides_an_error_in_motion_but_not_in_effort():
    control = {"position": 60.0, "velocity": 8.0}
    reference = {"column": "r", "unit": "rad"}
    made = swinging(predict="closed_loop", control=control, reference=reference)
    right, wrong = errors(RIGHT, made), errors(WRONG, made)
    assert wrong["window"] is None
    assert wrong["whole"]["position"]["rmse"] < 0.05
    assert wrong["effort"]["rmse"] > 3 * right["effort"]["rmse"]


def test_a_gain_on_the_rate_of_the_error_does_not_hold_the_axis_back():
    """On the speed alone it does, by kd/kp of it."""
    reference = {"column": "r", "unit": "rad"}
    held, led = (
        errors(RIGHT, swinging(predict="closed_loop", control=control, reference=reference))
        for control in ({"kp": 50.0, "kd": 8.0}, {"kp": 50.0, "kd": 8.0, "rate": "error"})
    )
    late = 8.0 / 50.0 * W * np.sqrt(0.5)
    assert held["whole"]["position"]["rmse"] == pytest.approx(late, rel=0.3)
    assert led["whole"]["position"]["rmse"] < 0.1 * late


def test_an_error_lies_within_its_interval_and_one_log_gives_none_of_the_whole():
    wrong = errors(WRONG)
    assert wrong["whole"]["position"]["interval"] == [None, None]
    for quantity in ("position", "speed"):
        low, high = wrong["window"][quantity]["interval"]
        assert low < wrong["window"][quantity]["rmse"] < high
    assert None not in errors(WRONG, swinging(2))["whole"]["position"]["interval"]


def test_guesses_without_a_model_miss_what_arithmetic_says():
    """Standing still misses sin(wt) - sin(wt0), speed w·cos(wt); a wrong model may do worse."""
    forward = Forward(swinging())
    still = forward.guessed()["standing still"]
    motion, (begin, first, last) = forward.problem.asked.motion, forward._long[0]
    assert begin == 0
    t = motion.seconds[first:last]
    missed = np.sin(W * t) - np.sin(W * t[0])
    assert still["whole"]["position"]["rmse"] == pytest.approx(np.sqrt(np.mean(missed**2)), 1e-3)
    speed = np.sqrt(np.mean((W * np.cos(W * t)) ** 2))
    assert still["window"]["speed"]["rmse"] == pytest.approx(speed, rel=1e-3)
    kept = forward.guessed()["keeping the speed"]
    assert kept["window"]["position"]["rmse"] < still["window"]["position"]["rmse"]


def test_without_inertia_there_is_no_motion_to_predict():
    assert "without inertia" in Forward(swinging()).absent({"rig.inertia": 0.0})
    assert Forward(swinging()).absent({"rig.inertia": J}) == ""
