"""Before a passive experiment a model gets the damping under which it moves as the robot did."""

import numpy as np
import pytest

from pipeline import sides
from spirob.experiments import Play, Side


def swing(damping):
    """A ring-down of two tendons [m/s]."""
    t = np.arange(1900)[:, None] * 1e-3
    speed = np.exp(-damping * 100 * t) * np.sin(2 * np.pi * 3 * t) * [1.0, -1.0]
    return Side(None, speed, speed, speed)


@pytest.mark.parametrize("damping", [0.008, 0.02, 0.05])
def test_the_damping_of_the_robot_is_found(monkeypatch, damping):
    def played(config, play, model):
        return swing(model["changes"][sides.DAMPING])

    monkeypatch.setattr(sides, "model_side", played)
    model = {"effects": ["capstan_friction"], "changes": {"arm.base_stiffness": 0.2}}
    found = sides.damped(None, Play("jumps", {}), model, swing(damping))
    assert found["changes"][sides.DAMPING] == pytest.approx(damping, rel=0.03)
    assert found["changes"]["arm.base_stiffness"] == 0.2
    assert found["effects"] == ["capstan_friction"]
