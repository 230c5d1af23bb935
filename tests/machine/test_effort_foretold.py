"""A law between an effort and its torque has to give the effort from the motion alone.

A propeller by equations of its own: steps of its speed, a current that grows with its square and is
measured with blows, of which a saturation about the measured current swallows what it likes.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

import spirob
from spirob.machine.axis import _foretelling
from spirob.machine.inverse.kernel_loop import solved
from spirob.machine.search.foretold import swallows
from tests.machine.forward.test_identity import BASE, POSSIBLE, asked_for

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


LAWS = {e.name(): e for e in POSSIBLE}
EFFICIENCY = {"direction_dependent_efficiency.back_excess": 0.4}
IRON = {"torque_constant_saturation.saturation": 0.15}


def model(names, changes):
    effects = tuple(LAWS[name] for name in names)
    return SimpleNamespace(effects=effects, fit=SimpleNamespace(changes=BASE | changes))


def with_blows(changes, size):
    """Models of an axis with these numbers, whose measured effort holds blows of this size."""
    made = asked_for(BASE | changes)
    blows = size * np.random.default_rng(5).standard_t(2.2, size=len(made.asked.motion.q))
    made.asked.motion = replace(made.asked.motion, effort=made.asked.motion.effort + blows)
    made._measured = made.smoothed(made.asked.motion.effort)
    return SimpleNamespace(train=made, heldout=made, least=0.01 * np.std(made.measured()))


@pytest.mark.parametrize(
    ("name", "true", "fitted", "blows", "does"),
    [
        ("torque_constant_saturation", {}, IRON, 0.3, True),
        ("torque_constant_saturation", IRON, IRON, 0.3, False),
        ("direction_dependent_efficiency", EFFICIENCY, EFFICIENCY, 0.3, False),
        ("coulomb_friction", {}, {}, 0.3, False),
    ],
)
def test_a_law_swallows_where_the_motion_alone_tells_the_effort_worse(
    name, true, fitted, blows, does
):
    models, one = with_blows(true, blows), model([name], fitted)
    assert swallows(models, one) == does
    if not does:  # then nothing is searched once more: two names of one law stay what they are
        done = SimpleNamespace(search=SimpleNamespace(models=models), chosen=one)
        assert _foretelling(done) is done
