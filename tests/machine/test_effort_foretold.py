"""A law between an effort and its torque has to give the effort from the motion alone.

A propeller by equations of its own: steps of its speed, a current that grows with its square and is
measured with blows, of which a saturation about the measured current swallows what it likes.
"""

import numpy as np
import pandas as pd
import pytest

import spirob
from spirob.machine.inverse.kernel_loop import solved

PERIOD, ROWS, STEPS, LAG = 0.03, 2400, 24, 0.25  # s, rows and steps of a log, s
INERTIA, DRAG, OFFSET = 2e-3, 2.2e-5, 0.3  # A s²/rad, A s²/rad², A
RIG = {
    "name": "propeller",
    "time": {"column": "t", "unit": "s"},
    "velocity": {"column": "v", "unit": "rad/s"},
    "effort": {"column": "i", "unit": "A", "kind": "current", "origin": "measured"},
    "fit": {
        "inertia": {"nominal": 2e-3, "low": 1e-6, "high": 1.0},
        "viscous": {"nominal": 1e-3, "low": 0.0, "high": 1.0},
    },
}


def propeller(seed):
    """72 s of steps of the speed between 60 and 600 rad/s."""
    rng = np.random.default_rng(seed)
    levels = np.repeat(rng.uniform(60.0, 600.0, STEPS), ROWS // STEPS)
    speed = np.empty(ROWS)
    now = levels[0]
    for k, level in enumerate(levels):
        now += (level - now) * PERIOD / LAG
        speed[k] = now
    current = INERTIA * np.gradient(speed, PERIOD) + DRAG * speed**2 + OFFSET
    read = {"v": speed + 0.5 * rng.normal(size=ROWS)}
    blows = 0.4 * rng.standard_t(2.2, size=ROWS)
    return pd.DataFrame({"t": np.arange(ROWS) * PERIOD, **read, "i": current + blows})


@pytest.mark.parametrize("seed", [13, 21])
def test_a_saturation_does_not_swallow_blows_of_the_current(seed):
    told = spirob.diagnose(RIG, train=[propeller(seed)], test=[propeller(seed + 1)])
    assert [one.name for one in told.findings] == ["quadratic_drag"], told.sentence
    assert told.findings[0].rivals == ()


@pytest.mark.parametrize("more", [0.3, 2.0, 9.0])
def test_an_effort_that_makes_more_than_itself_one_way_is_solved_for(more):
    """As a gear does that the load drives: up to ten times what it passes while driving."""
    forward = np.random.default_rng(4).choice([-1.0, 1.0], 400)

    def passed(effort):
        return effort * np.where(effort * forward < 0.0, 1.0 + more, 1.0)

    wanted = np.linspace(-2.0, 2.0, 400)
    np.testing.assert_allclose(passed(solved(passed, wanted)), wanted, atol=1e-11)
