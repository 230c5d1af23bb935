"""A known weight on the drum: the hoist's closed form, and nothing at all without one."""

import numpy as np
import pytest

from spirob.robot import Scene, Weights
from tests.emulator.conftest import loosen, mirrored, play

MASS, AMPERES, CYCLES = 2.0, 1.0, 200


def hoisted(machine, mass: float) -> tuple[float, dict]:
    """Length wound in [m] after `CYCLES` with slack tendons, and the machine's numbers."""
    made = mirrored(machine())
    made.start(Scene(weights=Weights(left=mass)), "hoist")
    loosen(made)
    before = made.state["wound"][0, 0]
    play(made, (AMPERES, 0.0), CYCLES)
    fields = made.numbers.dtype.names
    numbers = {name: np.ravel(made.numbers[name][0])[0] for name in fields}
    return made.state["wound"][0, 0] - before, numbers


@pytest.mark.parametrize("mass", [0.0, MASS])
def test_a_hoisted_weight_follows_the_closed_form(machine, mass):
    wound, p = hoisted(machine, mass)
    ratio, radius = p["gear_ratio"], p["winch_radius"]
    inertia = ratio**2 * p["rotor_inertia"] + p["winch_inertia"] + mass * radius**2
    damping = ratio**2 * p["rotor_damping"]
    torque = p["efficiency"] * ratio * p["torque_constant"] * AMPERES - radius * mass * 9.80665
    t, lag = 1e-3 * CYCLES, inertia / damping
    closed = radius * torque / damping * (t - lag * (1.0 - np.exp(-t / lag)))
    assert wound == pytest.approx(closed, rel=0.01)  # the current rises within half a millisecond


def test_a_weight_is_gone_in_the_next_trial(machine):
    made = machine()
    made.start(Scene(weights=Weights(1.0, 2.0)), "with")
    assert made.numbers["hung_mass"][0].tolist() == [1.0, 2.0]
    made.start(Scene(), "without")
    assert made.numbers["hung_mass"][0].tolist() == [0.0, 0.0]
