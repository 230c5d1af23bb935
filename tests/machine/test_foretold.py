"""A law that swings by itself has to give the motion, too: else its name does not stand."""

import copy
from types import SimpleNamespace

import pytest

from spirob.machine.search.foretold import misleading
from tests.machine.forward.test_identity import BASE, POSSIBLE, asked_for

SHAFT = next(e for e in POSSIBLE if e.name() == "gear_compliance")
TRUE = {"load_inertia": 0.03, "frequency": 4.0, "damping": 0.1}


def numbers(**changes):
    return BASE | {f"gear_compliance.{name}": value for name, value in (TRUE | changes).items()}


def model(changes, *effects):
    return SimpleNamespace(effects=effects, fit=SimpleNamespace(changes=changes))


def misled(said, effect=SHAFT, names=("gear_compliance",), without=BASE, held=None):
    """What misleads of a model with these numbers, where the axis has the true ones.

    without  numbers of the model without it;  held  trials held out, the fitted ones again
    """
    axis = asked_for(numbers())
    search = SimpleNamespace(
        models=SimpleNamespace(train=axis, heldout=held or axis),
        without=lambda chosen, effect: model(without),
    )
    return misleading(search, model(said, effect), names)


@pytest.mark.parametrize(
    "changes", [{}, {"load_inertia": 0.04}, {"frequency": 5.0}, {"damping": 0.3}]
)
def test_a_shaft_about_as_it_is_stands(changes):
    assert misled(numbers(**changes)) == []


def test_a_shaft_that_leaves_the_motor_no_inertia_misleads():
    heavy = numbers(load_inertia=1.03 * BASE["rig.inertia"])
    assert misled(heavy) == ["gear_compliance"]
    assert misled(heavy, names=()) == []


def test_where_the_model_runs_away_without_it_as_well_nothing_is_said():
    heavy = numbers(load_inertia=1.03 * BASE["rig.inertia"])
    light = BASE | {"rig.inertia": 0.02 * BASE["rig.inertia"], "rig.viscous": 0.0}
    assert misled(heavy, without=light) == []


def test_what_does_not_swing_by_itself_is_not_asked():
    friction = next(e for e in POSSIBLE if e.name() == "coulomb_friction")
    wrong = BASE | {"coulomb_friction.coulomb_torque": 3.0}
    assert misled(wrong, friction, ["coulomb_friction"]) == []


def test_logs_that_were_fitted_deny_what_held_out_rest_does_not():
    still = copy.deepcopy(asked_for(numbers()))
    for recording in still.recordings:
        for piece in recording.pieces:
            piece.use[20:] = False
    heavy = numbers(load_inertia=1.03 * BASE["rig.inertia"])
    assert misled(heavy, held=still) == ["gear_compliance"]
