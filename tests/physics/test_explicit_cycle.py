"""When the literal cycle diverges, and that the coupled model is the same physics where it lives.

The previous cycle's acceleration comes back with the gain J_eq/r² over the arm's inertia at the
tendon, 1/(J M⁻¹ Jᵀ): below one it converges, above one it doubles and redoubles.
"""

from dataclasses import replace

import numpy as np
import pytest

from spirob.plant import Plant
from spirob.plant.rig import Motor
from spirob.robot import Scene
from tests.physics.explicit_cycle import STEP, explicit_cycle, tendon_inertia
from tests.physics.playing import DIRECT, RIGS, currents

NEWTON = 0.2


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    # MuJoCo writes its warnings to a file where it runs
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(("ratio", "within"), [("geared", 0.01), ("direct", 0.1)])
def test_coded_literally_the_cycle_diverges_within_milliseconds(ratio, within):
    rig = RIGS[ratio]
    diverged, _ = explicit_cycle(rig, NEWTON * rig.winch.radius, 0.3)
    assert diverged is not None
    assert diverged < within
    amperes = NEWTON / (rig.winch.efficiency * rig.motor.torque_constant / rig.winch.radius)
    amperes /= rig.winch.gear_ratio
    coupled = Plant(rig).simulate(currents(np.full(300, amperes), 0.0), Scene())
    assert np.isfinite(coupled.angles).all()


def test_low_passing_the_acceleration_does_not_save_the_geared_machine():
    rig = RIGS["geared"]
    for smoothing in (0.9, 0.99, 0.999):
        diverged, _ = explicit_cycle(rig, NEWTON * rig.winch.radius, 0.3, smoothing)
        assert diverged is not None


class LightRotor(Motor):
    """Bounds of a real motor do not hold here."""

    owner = "motor"

    def __post_init__(self) -> None:
        pass


def light(share):
    """The direct machine with a rotor of this share of the arm's inertia at the tendon."""
    inertia = share * tendon_inertia(DIRECT) * DIRECT.winch.radius**2
    return replace(DIRECT, motor=LightRotor(rotor_inertia=inertia, rotor_damping=1e-5))


@pytest.mark.parametrize(("share", "diverges"), [(0.3, False), (0.9, False), (2.0, True)])
def test_it_diverges_when_the_rotor_outweighs_the_arm_at_the_tendon(share, diverges):
    rig = light(share)
    when, _ = explicit_cycle(rig, NEWTON * rig.winch.radius, 0.3)
    assert (when is not None) == diverges


def test_where_it_converges_it_agrees_with_the_coupled_model():
    rig = light(0.3)
    amperes = NEWTON * rig.winch.radius / (rig.winch.efficiency * rig.motor.torque_constant)
    _, rates = explicit_cycle(rig, NEWTON * rig.winch.radius, 0.4)
    pull = currents(np.full(400, amperes), -0.05)  # the right tendon slack, as there
    coupled = Plant(rig).simulate(pull, Scene())
    travelled = np.cumsum(rates) * STEP
    assert coupled.shortening[-1, 0] == pytest.approx(travelled[-2], rel=0.01)
    assert coupled.tension[-1, 1] == 0.0
