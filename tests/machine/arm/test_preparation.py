"""What a search on an arm's logs stands on: the shape that they show, and what of them counts."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.diagnosis.criteria import Settings
from spirob.diagnosis.simulated import ROLES
from spirob.effects import find_effects
from spirob.identify import builds
from spirob.identify.builds import RESOLUTION
from spirob.identify.fit import fit
from spirob.identify.residual import Residual, near
from spirob.logs.readers import Table
from spirob.machine.arm import preparation
from spirob.machine.arm.preparation import settled, settled_with
from spirob.machine.arm.replay import arm_trial
from spirob.machine.arm.shape import SHAPE
from spirob.plant import Plant
from tests.identify.known import moves
from tests.machine.arm.elsewhere import exchanged, played, rig

NAMES = ["winch.efficiency", "motor.rotor_damping", "arm.base_stiffness", "arm.bends_per_hinge"]
TRUE = {"winch.efficiency": 0.7, "motor.rotor_damping": 1.3e-4, "arm.bends_per_hinge": 1.2}
ELSEWHERE = {"holes.shift": 0.15, "holes.mount": 0.02}


def as_commanded(true, effects=()):
    """Two bends against so much current that both tendons would push a hinge of a point over."""
    for k, motor in enumerate(("left", "right")):
        bend = moves(motor, [[0.1, 0.0], [1.2, 0.03], [0.7, 0.012], [0.9, 0.025]], 0.6)
        yield played({"name": motor, "role": "train", **bend, "duration": 3.0}, true, effects, k=k)


def settle(true, logged=dict):
    columns = [logged(c) for c in as_commanded(true)]
    logs = [arm_trial(Table(f"{k}", c), rig(), "train")[0] for k, c in enumerate(columns)]
    plant = Plant(rig().machine())
    residuals = {role: Residual(plant, [replace(t, role=role) for t in logs]) for role in ROLES}
    return residuals, settled(residuals, NAMES, {}, list(SHAPE), Settings(), print)


def test_an_arm_as_drawn_is_asked_nothing_else():
    residuals, found = settle(TRUE)
    assert found.said == []
    assert found.residuals == residuals
    assert found.as_drawn
    assert not any(name.startswith("holes.") for name in found.numbers)


def test_logs_that_make_no_sense_are_asked_for_no_shape(monkeypatch):
    """A search of minutes would find what makes up for columns that are exchanged."""
    monkeypatch.setattr(preparation, "searched_shape", None)
    _, found = settle({**TRUE, **ELSEWHERE}, exchanged)
    assert found.as_drawn
    assert found.said == []


def test_holes_that_lie_elsewhere_are_found_and_said():
    """Not each number by itself: holes, exponent and bends of a hinge do nearly the same."""
    residuals, found = settle({**TRUE, **ELSEWHERE})
    train = residuals["train"]
    plain = fit(near(train, {}), NAMES, {}, Settings().scale, exact=False).changes
    missed, before = (np.std(train(n)[train.rows]) for n in (found.numbers, plain))
    assert missed < 0.8 * before
    assert found.numbers["holes.shift"] != 0.0
    assert any("not as drawn" in text for text in found.said)
    assert not found.as_drawn


def test_beside_an_effect_every_row_weighs_by_what_builds_with_it_leave_open(monkeypatch):
    """And the shape is searched for from the fit with the effect, among what is free.

    The logs are read as if without noise, beside which rows would weigh nearly alike: between the
    samples of 2 ms those of the model's clock lie on straight lines.
    """
    monkeypatch.setattr(builds, "DRAWS", 9)
    begun = []
    monkeypatch.setattr(
        preparation, "searched_shape", lambda train, found, *given: begun.append(found) or {}
    )
    friction = find_effects(["capstan_friction"])
    columns = as_commanded({**TRUE, "capstan_friction.friction": 0.1}, friction)
    logs = [arm_trial(Table(f"{k}", c), rig(), "train")[0] for k, c in enumerate(columns)]
    plant = Plant(rig().machine(), friction)
    residuals = {
        role: Residual(plant, [replace(t, role=role, every=1) for t in logs]) for role in ROLES
    }
    names = [*NAMES, "capstan_friction.friction"]
    with_it = fit(near(residuals["train"], {}), names, {}, Settings().scale, exact=False)
    found = settled_with(residuals, with_it, list(SHAPE), Settings(), print)
    assert list(begun[0].estimates) == names
    for role, residual in found.residuals.items():
        weights = np.concatenate([residual.weight(t) for t in residual.trials])
        assert np.mean(weights**2) == pytest.approx(1.0)
        assert np.ptp(weights) > 0.1, role
    missed, plain = (
        np.std(found.residuals["train"](n)[residuals["train"].rows])
        for n in (found.numbers, {n: v for n, v in with_it.changes.items() if n in NAMES})
    )
    assert missed < 0.5 * plain
    assert found.floor.share >= RESOLUTION
    assert "Every sample counts by how far builds are apart there" in found.floor.reason
