"""The atlas of a machine of any kind: orders of its motor, and the lag behind its command."""

import numpy as np
import pytest

from spirob.diagnosis.spectrum import orders
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import sizes_of
from spirob.machine.recordings.recording import prepare

GEAR = 50.0


def problem(unit="rad", gear=GEAR):
    given = {"column": "x", "unit": unit}
    rig = RigFile.model_validate(
        {
            "name": "servo",
            "time": {"column": "t", "unit": "s"},
            "position": given,
            "reference": {**given, "column": "asked"},
            "effort": {"column": "u", "kind": "torque", "unit": "N·m"},
            "known": {"inertia": 0.1, "delay": 0.0},
            "fit": {"viscous": {"nominal": 0.1, "low": 0.0, "high": 9.0}},
        }
        | ({"gear": gear} if gear else {})
    )
    t = np.arange(0.0, 8.0, 2e-3)
    logs = []
    for k in range(2):
        x = np.sin(1.1 * t + k) + 0.3 * np.sin(3.1 * t)
        u = np.sin(2.0 * t) + 0.2 * np.cos(6 * GEAR * x)
        logs.append(prepare(f"log {k}", {"t": t, "x": x, "u": u, "asked": x + 0.1}, rig))
    return InverseProblem(rig, None, logs, [], *sizes_of(rig, None, logs))


def test_a_wave_of_the_motor_behind_a_gear_is_found_with_its_order():
    rig = problem()
    angle = np.concatenate([p.angle for p in rig.stretches()])
    (found,) = orders(rig.stretches(), np.cos(6.0 * angle))
    assert (found.of, found.order) == ("motor", pytest.approx(6.0, rel=1e-3))


def test_a_slide_without_a_gear_counts_over_its_stroke():
    assert {p.turn for p in problem("m", gear=None).stretches()} == {"stroke"}
    assert {p.turn for p in problem(gear=None).stretches()} == {"motor"}


def test_the_lag_is_what_the_command_is_ahead():
    for piece in problem().stretches():
        assert piece.lag == pytest.approx(0.1, abs=2e-3)
        assert piece.command_rate == pytest.approx(piece.velocity, abs=0.05)
