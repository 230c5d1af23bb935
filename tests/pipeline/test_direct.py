"""Before a passive experiment a model gets the numbers under which it moves as the robot did."""

from types import SimpleNamespace

import numpy as np
import pytest

from pipeline import sides
from spirob.experiments import Play, Side

SWUNG = [f"arm.{name}" for name in sides.SWING]


def swing(damping, stiffness, armature):
    """A ring-down of two tendons [m/s]: a slow mode, and a fast one that added inertia slows."""
    t = np.arange(1900)[:, None] * 1e-3
    slow = 2 * np.pi * 3 * np.sqrt(stiffness / 0.15)
    fast = 2 * np.pi * 15 * np.sqrt(stiffness / 0.15 / (1 + armature / 5e-5))
    speed = sum(np.exp(-damping * 100 * t) * np.sin(w * t) for w in (slow, fast))
    speed = speed * [1.0, -1.0]
    return Side(None, speed, speed, speed)


@pytest.mark.parametrize("numbers", [(0.015, 0.16, 4e-5), (0.02, 0.145, 2e-5), (0.03, 0.15, 6e-5)])
def test_what_the_robots_swing_tells_is_found(monkeypatch, numbers):
    def played(config, play, model):
        return swing(*(model["changes"][name] for name in SWUNG))

    monkeypatch.setattr(sides, "model_side", played)
    model = {"effects": ["capstan_friction"], "changes": {"motor.rotor_inertia": 2e-5}}
    found = sides.swinging(SimpleNamespace(rig={}), Play("jumps", {}), model, swing(*numbers))
    assert [found["changes"][name] for name in SWUNG] == pytest.approx(numbers, rel=0.03)
    assert found["changes"]["motor.rotor_inertia"] == 2e-5
    assert found["effects"] == ["capstan_friction"]
