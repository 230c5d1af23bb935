"""A body from a model file: its torque is right, and the file is only data."""

import numpy as np
import pytest

from spirob.errors import ConfigError, DataError
from spirob.machine.description.rig import Body
from spirob.machine.inverse.body import RigidBody
from spirob.machine.recordings.recording import Piece
from tests.machine.rigs import PENDULUM


def piece(n=50):
    t = np.linspace(0, 1, n)
    q, v, a = np.sin(3 * t), 3 * np.cos(3 * t), -9 * np.sin(3 * t)
    return Piece(t, q, q, v, a, np.zeros(n), np.zeros(n), np.ones(n, bool), np.zeros(n, bool))


def body(tmp_path, text=PENDULUM, **changes):
    (tmp_path / "link.xml").write_text(text)
    given = {"mjcf": "link.xml", "joint": "shoulder", "tip": "hand", **changes}
    return RigidBody(Body.model_validate(given), tmp_path, True)


def test_a_pendulum_needs_what_its_equation_says(tmp_path):
    made, trial = body(tmp_path), piece()
    needs = made.needs(trial, 0.2)
    inertia, weight = 0.003 + 0.4 * 0.15**2, 9.81 * 0.4 * 0.15
    np.testing.assert_allclose(
        needs["load"], inertia * trial.a + weight * np.sin(trial.q), atol=1e-9
    )
    payload = 0.2 * 0.3**2 * trial.a + 9.81 * 0.2 * 0.3 * np.sin(trial.q)
    np.testing.assert_allclose(needs["payload"], payload, atol=1e-9)


def test_the_model_is_as_before_after_a_payload_was_tried(tmp_path):
    made, trial = body(tmp_path), piece()
    first = made.needs(trial, 0.2)
    second = made.needs(trial, 0.2)
    for name in first:
        np.testing.assert_allclose(first[name], second[name], atol=1e-12)


def test_a_tendon_drives_through_its_lever(tmp_path):
    radius = 0.02
    text = PENDULUM.replace('name="shoulder"', 'name="shoulder" range="-90 90"').replace(
        "</worldbody>",
        '</worldbody><tendon><fixed name="belt"><joint joint="shoulder" coef="0.02"/>'
        "</fixed></tendon>",
    )
    made = body(tmp_path, text, joint=None, tendon="belt")
    swing, belt = piece(), piece()
    belt.q, belt.v, belt.a = (radius * x for x in (swing.q, swing.v, swing.a))
    along = made.needs(belt, 0.1)["load"]
    np.testing.assert_allclose(
        along, body(tmp_path).needs(swing, 0.1)["load"] / radius, rtol=1e-3, atol=1e-3
    )


def test_a_body_that_is_no_machine_is_a_sentence(tmp_path):
    with pytest.raises(ConfigError, match=r"gravity of a <option> is '.*nan', no number"):
        body(tmp_path, PENDULUM.replace("-9.81", "nan"))
    with pytest.raises(ConfigError, match=r"gravity of a <option> is .*, no number of a machine"):
        body(tmp_path, PENDULUM.replace("-9.81", "-1e308"))
    made = body(tmp_path, PENDULUM.replace("-9.81", "-1e15").replace('mass="0.4"', 'mass="1e9"'))
    with pytest.raises(DataError, match="asks for an effort of"):
        made.needs(piece(), 0.2)


def test_an_unknown_joint_or_tip_lists_what_exists(tmp_path):
    with pytest.raises(ConfigError, match="no joint 'elbow'; it has: shoulder"):
        body(tmp_path, joint="elbow")
    with pytest.raises(ConfigError, match="no site or body 'foot'"):
        body(tmp_path, tip="foot")
