"""A described link behind a gear that loses both ways, and a spring of friction that slips.

Motions are imposed, efforts in closed form, by equations of their own.
"""

import numpy as np
import pytest

from tests.machine.judging import diagnosed
from tests.machine.rigs import PENDULUM, Case, description

OWN, CARRIED, VISCOUS = 0.004, 0.003 + 0.4 * 0.15**2, 0.05
WEIGHT = 9.81 * 0.4 * 0.15


def motion(rng):
    """Ten seconds of tones at 200 Hz: time, angle, speed, rate of the speed."""
    t = np.arange(0.0, 10.0, 5e-3)
    w = 2 * np.pi * np.array([0.23, 0.61, 0.97])
    size, phase = np.array([1.0, 0.5, 0.25]) * rng.uniform(0.8, 1.2, 3), rng.uniform(0, 6, 3)
    at = np.outer(t, w) + phase
    return t, np.sin(at) @ size, np.cos(at) @ (size * w), -np.sin(at) @ (size * w**2)


def logged(rng, t, q, effort):
    noise = rng.standard_normal((2, len(t)))
    return {"t": t, "q": q + 1e-5 * noise[0], "u": effort + 2e-3 * np.std(effort) * noise[1]}


def geared(rng, forward, back):
    """The motor's torque: a part of it is lost while it drives, more holds while it is driven."""
    t, q, v, a = motion(rng)
    passed = (OWN + CARRIED) * a + VISCOUS * v + WEIGHT * np.sin(q)
    return logged(rng, t, q, passed / np.where(passed * v > 0, 1.0 - forward, 1.0 + back))


@pytest.mark.parametrize(("forward", "back"), [(0.25, 0.25), (0.1, 0.4)])
def test_a_gear_that_loses_both_ways_has_one_name(forward, back, tmp_path):
    rng = np.random.default_rng(20401)
    logs = [geared(rng, forward, back) for _ in range(3)]
    rig = description(
        body={"mjcf": "link.xml", "joint": "shoulder", "tip": "hand"}, known={"scale": 1.0}
    )
    case = Case(rig, logs[:2], logs[2], {"named"}, [], {"link.xml": PENDULUM})
    told = diagnosed(case, tmp_path)
    assert told["verdict"] == "named", told["sentence"]
    (effect,) = told["effects"]
    assert effect["name"] == "direction_dependent_efficiency"
    assert effect["parameters"]["forward_loss"]["value"] == pytest.approx(forward, abs=0.03)
    assert effect["parameters"]["back_excess"]["value"] == pytest.approx(back, abs=0.06)


def slipping(rng, level, way):
    """An axis whose friction is a spring that slips once it is wound up over `way`."""
    t, q, v, a = motion(rng)
    wound, friction = 0.0, np.empty(len(q))
    for k, step in enumerate(np.diff(q, prepend=q[0])):
        wound = min(max(wound + step / way, -1.0), 1.0)
        friction[k] = level * wound
    return logged(rng, t, q, 0.03 * a + VISCOUS * v + friction)


def test_presliding_friction_by_another_curve_than_dahl_s_keeps_its_name(tmp_path):
    rng = np.random.default_rng(20402)
    logs = [slipping(rng, 0.5, 0.12) for _ in range(3)]
    told = diagnosed(Case(description(), logs[:2], logs[2], {"named"}), tmp_path)
    assert told["verdict"] == "named", told["sentence"]
    assert [e["name"] for e in told["effects"]] == ["presliding_friction"]
    assert told["effects"][0]["parameters"]["exponent"]["value"] < 0.3
