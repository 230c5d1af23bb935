"""An effort of one size is not explained by itself.

A dead band of that size takes all of it away, and dry friction all that viscous friction takes.  A
cart between two ends, driven by a relay whose current turns its sign at random, and a wheel that is
turned round once a log, in equations of their own.
"""

import numpy as np
import pytest

from tests.machine.judging import diagnosed
from tests.machine.rigs import Case

MASS, DRAG, PER_AMPERE, RATE = 6.0, 15.0, 3.3, 300


def log(rng, dry, sizes):
    """Twenty seconds under currents of these sizes [A] against a dry friction [N]."""
    fine, every, x, v, amperes, until = 1e-3, 1000 // RATE, 0.0, 0.0, sizes[0], 0.0
    rows = []
    for k in range(20_000):
        if k * fine >= until:
            amperes = rng.choice(sizes) * (-1.0 if x + 0.01 * rng.normal() > 0.0 else 1.0)
            until = k * fine + rng.uniform(0.1, 0.4)
        v += fine * (PER_AMPERE * amperes - DRAG * v - dry * np.tanh(v / 2e-3)) / MASS
        x += fine * v
        if k % every == 0:
            rows.append((k * fine, x + 2e-5 * rng.normal(), amperes))
    return dict(zip("tqu", np.array(rows).T, strict=True))


@pytest.mark.parametrize(("dry", "right"), [(3.0, "named"), (0.0, "nothing_missing")])
def test_a_relay_hides_no_dead_band(dry, right, tmp_path):
    rig = {
        "name": "cart under a relay",
        "time": {"column": "t", "unit": "s"},
        "position": {"column": "q", "unit": "m"},
        "effort": {
            "column": "u",
            "unit": "A",
            "kind": "current",
            "origin": "command",
            "limit": 10.0,
        },
        "known": {"scale": PER_AMPERE},
        "fit": {
            "inertia": {"nominal": 4.0, "low": 0.5, "high": 60.0},
            "viscous": {"nominal": 1.0, "low": 0.0, "high": 100.0},
        },
    }
    logs = [log(np.random.default_rng(18400 + k), dry, [4.0]) for k in range(3)]
    told = diagnosed(Case(rig, logs[:2], logs[2], []), tmp_path)
    assert told["verdict"] == right, told["sentence"]
    assert [e["name"] for e in told["effects"]] == ["coulomb_friction"] * (dry > 0.0)
    assert told["numbers"]["inertia"]["value"] == pytest.approx(MASS, rel=0.15)


SIZE, WHEEL, LOSS, STEP = 0.15, 2.2e-4, 3.4e-3, 0.77  # of the duty; per its unit; rad/s of a count


def turned_round(rng, first=SIZE, then=-SIZE):
    """Two seconds of a wheel whose drag comes and goes by a twentieth, under two duties."""
    fine, every, v, rows = 1e-4, 20, 0.0, []
    slow = np.repeat(np.cumsum(rng.normal(size=20)), 1000)
    slow = 0.05 * (slow - slow.mean()) / slow.std()
    for k in range(20_000):
        u = first if k < 9_000 else then
        v += fine * (u - LOSS * (1.0 + slow[k]) * v) / WHEEL
        if k % every == 0:
            rows.append((k * fine, STEP * np.round((v + 0.5 * rng.normal()) / STEP), 100.0 * u))
    return dict(zip("tvu", np.array(rows).T, strict=True))


@pytest.mark.parametrize("duties", [(SIZE, -SIZE), (0.0, SIZE)])
def test_a_speed_that_scatters_under_one_size_of_effort_is_no_dry_friction(duties, tmp_path):
    """Dry friction would leave a thousandth of the effort: it is the effort, up to a factor.

    So would a constant, where the wheel goes one way.
    """
    rig = {
        "name": "wheel",
        "time": {"column": "t", "unit": "s"},
        "velocity": {"column": "v", "unit": "rad/s"},
        "effort": {"column": "u", "unit": "%", "kind": "duty", "origin": "command", "supply": 1},
        "fit": {
            "inertia": {"nominal": 5e-4, "low": 1e-6, "high": 1.0},
            "viscous": {"nominal": 5e-3, "low": 0.0, "high": 1.0},
        },
    }
    logs = [turned_round(np.random.default_rng(18600 + k), *duties) for k in range(3)]
    told = diagnosed(Case(rig, logs[:2], logs[2], []), tmp_path)
    assert told["effects"] == [], told["sentence"]
    assert any("far worse with it than without" in note for note in told["repairs"])
