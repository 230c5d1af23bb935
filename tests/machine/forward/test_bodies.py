"""A body from a model file run forward: as MuJoCo runs it, and as mechanics says it must."""

import numpy as np
import pytest
from scipy.special import ellipk

from spirob.machine.forward import Forward
from tests.machine.forward.bodies import PERIOD, link, missed, moved, problem, run

# of what filter and differences leave of a logged start, 1e-5 of its speed
CLOSE = 2e-4
LEVER = """<mujoco><option gravity="0 0 -9.81"/><worldbody>
<site name="anchor" pos="0.1 0 0.2"/><body name="link">
<joint name="shoulder" type="hinge" axis="0 1 0" range="-70 40"/>
<inertial pos="0 0 -0.15" mass="0.4" diaginertia="0.003 0.003 0.0001"/>
<site name="hand" pos="0.05 0 -0.1"/></body></worldbody><tendon><spatial name="belt">
<site site="anchor"/><site site="hand"/></spatial></tendon></mujoco>"""
TWO = """<mujoco><option gravity="0 0 -9.81"/><worldbody><body name="upper">
<joint name="shoulder" type="hinge" axis="0 1 0" damping="0.01"/>
<inertial pos="0 0 -0.15" mass="0.4" diaginertia="0.003 0.003 0.0001"/>
<body name="lower" pos="0 0 -0.3"><joint name="elbow" type="hinge" axis="0 1 0" damping="0.02"/>
<inertial pos="0 0 -0.1" mass="0.3" diaginertia="0.002 0.002 0.0001"/>
</body></body></worldbody></mujoco>"""


def test_a_pendulum_swings_with_its_period(tmp_path):
    """T = T0·(2/π)·K(sin²(A/2)), counted over its passages through rest at the bottom."""
    made = problem(tmp_path, link(), moved(link(), [1.8], 12.0))
    t, (_, q), _ = run(made)
    k = np.flatnonzero((q[:-1] < 0) & (q[1:] >= 0))
    passed = t[k] - q[k] * (t[k + 1] - t[k]) / (q[k + 1] - q[k])
    period = PERIOD * 2 / np.pi * ellipk(np.sin(0.9) ** 2)
    assert len(passed) > 5
    np.testing.assert_allclose(np.diff(passed), period, rtol=1e-5)


def test_a_pendulum_keeps_its_energy(tmp_path):
    made = problem(tmp_path, link(), moved(link(), [1.8], 20.0))
    _, (_, q), (_, v) = run(made)
    energy = 0.5 * (0.003 + 0.4 * 0.15**2) * v**2 - 9.81 * 0.4 * 0.15 * np.cos(q)
    np.testing.assert_allclose(energy, energy[0], atol=1e-5 * 9.81 * 0.4 * 0.15)


@pytest.mark.parametrize(
    "joint",
    [{}, {"armature": 0.01}, {"stiffness": 0.4, "springref": 30}],
    ids=str,
)
def test_an_arm_moves_as_mujoco_moves_it(tmp_path, joint):
    text = link(damping=0.02, **joint)
    log = moved(text, [0.3], 8.0, lambda t: [0.2 * np.sin(5 * t)])
    _, (measured, q), (speed, v) = run(problem(tmp_path, text, log))
    np.testing.assert_allclose(q, measured, atol=CLOSE)
    np.testing.assert_allclose(v, speed, atol=10 * CLOSE)


@pytest.mark.parametrize("pull", [0.0, 0.3])
def test_a_tendon_pulls_through_its_changing_lever(tmp_path, pull):
    """Free fall and a pull; the lever goes from 0.10 to 0.04 m over this motion."""
    log = moved(LEVER, [-0.3], 6.0, lambda t: [pull * np.sin(4 * t)], tendon=True)
    body = {"joint": None, "tendon": "belt"}
    made = problem(
        tmp_path,
        LEVER,
        log,
        body=body,
        position={"column": "q", "unit": "m"},
        effort={"column": "u", "unit": "N", "kind": "force"},
    )
    _, (measured, q), _ = run(made)
    assert np.ptp(measured) > 0.02
    np.testing.assert_allclose(q, measured, atol=1e-4 * np.ptp(measured))


def test_the_other_joint_moves_as_it_was_measured(tmp_path):
    """A double pendulum of MuJoCo; with the elbow's motion from the log the shoulder follows."""
    log = moved(TWO, [0.8, -0.5], 5.0, lambda t: [0.3 * np.sin(6 * t), 0.1 * np.cos(9 * t)])
    made = problem(tmp_path, TWO, log, body={"joints": {"elbow": {"column": "q1", "unit": "rad"}}})
    _, (measured, q), _ = run(made)
    np.testing.assert_allclose(q, measured, atol=CLOSE)
    assert missed(made, {"rig.viscous": 0.0})["window"] < 2e-4


def test_dry_friction_of_the_model_file_stops_a_slide(tmp_path):
    """½·m·v² = F·s: 0.5 kg at 1 m/s against 2 N slide 0.125 m."""
    text = """<mujoco><worldbody><body name="link"><joint name="shoulder" type="slide"
    axis="1 0 0" frictionloss="2"/><inertial pos="0 0 0" mass="0.5" diaginertia="1 1 1"/>
    </body></worldbody></mujoco>"""
    t = np.arange(0, 2.0, 1e-3)
    run_up = np.minimum(t, 0.5)
    left = np.clip(t - 0.5, 0, 0.25)
    q = run_up + left - 2 * left**2
    u = np.where(t < 0.5, 2.0, 1e-3 * np.sin(40 * t))
    made = problem(
        tmp_path,
        text,
        {"t": t, "q": q, "u": u},
        position={"column": "q", "unit": "m"},
        effort={"column": "u", "unit": "N", "kind": "force"},
    )
    _, (measured, found), _ = run(made)
    np.testing.assert_allclose(found, measured, atol=2e-3)


def test_a_payload_makes_the_period_longer(tmp_path):
    """0.2 kg at 0.3 m; the log is that of the link with it, the model file knows nothing of it."""
    loaded = link().replace(
        "</body>",
        '<body pos="0 0 -0.3"><inertial pos="0 0 0" mass="0.2" diaginertia="1e-9 1e-9 1e-9"/>'
        "</body></body>",
    )
    log = moved(loaded, [0.5], 8.0, lambda t: [0.3 * np.sin(3 * t)])
    made = problem(tmp_path, link(), log, ["tip_payload"], {"tip": "hand"})
    changes = {"rig.viscous": 0.0, "tip_payload.mass": 0.2}
    _, (measured, q), _ = run(made, changes)
    np.testing.assert_allclose(q, measured, atol=1e-3)
    assert missed(made, {"rig.viscous": 0.0})["whole"] > 0.05


def test_a_tilted_mount_is_a_tilted_gravity(tmp_path):
    tilt = 0.1
    text = link().replace(
        'gravity="0 0 -9.81"', f'gravity="{9.81 * np.sin(tilt)} 0 {-9.81 * np.cos(tilt)}"'
    )
    log = moved(text, [0.5], 6.0, lambda t: [0.3 * np.sin(3 * t)])
    made = problem(tmp_path, link(), log, ["mount_tilt"])
    numbers = [n for n in made.table.about if n.startswith("mount_tilt")]
    best = min(
        missed(made, {"rig.viscous": 0.0, name: sign * tilt})["whole"]
        for name in numbers
        for sign in (1, -1)
    )
    # the effect adds the weight's new part and leaves the old one: 1 - cos(0.1) of it is left
    assert best < 0.3 * missed(made, {"rig.viscous": 0.0})["whole"]


def test_a_fluid_is_refused_in_a_sentence(tmp_path):
    text = link().replace("<option", '<option density="1000" viscosity="0.1"')
    made = problem(tmp_path, text, moved(text, [0.5], 3.0))
    assert "is not of the form" in Forward(made).absent({"rig.viscous": 0.0})
