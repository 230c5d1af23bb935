"""A sign, or a drift, is blamed only where it makes the model fit."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spirob.diagnosis.criteria import Criteria
from spirob.diagnosis.search import Search
from spirob.identify.intervals import Estimate
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import Sizes
from spirob.machine.laws import LEVER
from spirob.machine.recordings.recording import prepare
from spirob.machine.search import plausibility
from spirob.machine.search.leftovers import drifting
from spirob.machine.search.models import Models
from spirob.machine.search.plausibility import (
    _computed,
    _of_another_size,
    _senseless,
    _turned,
    doubts,
    oddities,
    untaught,
)
from spirob.machine.search.wrong_numbers import without_sign
from tests.machine.rigs import description


@pytest.mark.parametrize(
    ("delay", "said"),
    [
        (
            Estimate(0.002, 0.001, 0.003, "s", False),
            "trails the motion by 2 ms in the logs; aligned.",
        ),
        (Estimate(-0.087, -0.12, -0.028, "s", False), "leads the motion by 87 ms (28 to 120) in"),
        (Estimate(0.094, 0.059, 0.12, "s", False), "trails the motion by 94 ms (59 to 120) in"),
        (Estimate(0.02, -0.02, 0.02, "s", True), "ended at the bound"),
    ],
)
def test_a_delay_that_is_not_usual_is_told_with_its_interval(delay, said):
    assert said in plausibility.aligned(delay, 0.01)


SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")


def search_of(effort, noise=0.0, onward=0.0, origin="measured"):
    """A search over one log of an axis with inertia, friction and a weight.

    noise  of its position [rad];  onward  speed at which it goes on besides [rad/s]
    """
    rig = RigFile.model_validate(description())
    rig = rig.model_copy(update={"effort": rig.effort.model_copy(update={"origin": origin})})
    t = np.arange(0, 10, 2e-3)
    q, v = np.sin(3 * t) + 0.3 * np.sin(7.1 * t), 3 * np.cos(3 * t) + 2.13 * np.cos(7.1 * t)
    a = -9 * np.sin(3 * t) - 15.1 * np.sin(7.1 * t)
    read = q + onward * t + noise * np.random.default_rng(1).normal(size=len(q))
    made = [prepare("log", {"t": t, "q": read, "u": effort(q, v, a)}, rig)]
    problem = InverseProblem(rig, None, made, list(LEVER.values()), SIZES, 0.02)
    return Search(Models(problem, problem, ["rig.inertia", "rig.viscous"]), [], Criteria())


def test_a_sign_is_blamed_only_where_turning_it_makes_the_model_fit():
    def resisting(q, v, a):
        return 0.01 * a + 0.05 * v + 0.1 * np.tanh(v / 0.02) + 0.2 * np.sin(q)

    def said(effort):
        search = search_of(effort)
        return _turned(search, search.models.fitted((), {}))

    assert said(resisting) == ""
    assert "factor -1" in said(lambda *motion: -resisting(*motion))
    turned = said(lambda *motion: -resisting(*motion))
    assert "as it is all but 95%" in turned
    assert "controller" not in turned  # a measured effort is no answer to the motion
    noise = np.random.default_rng(0).normal(size=5000)
    assert said(lambda q, v, a: noise) == ""


@pytest.mark.parametrize(
    ("inertia", "viscous", "origin", "other", "doubted"),
    [
        (0.0, 0.0, "command", 0.0, True),
        (0.0, 0.0, "measured", 0.0, False),
        (0.0, 0.05, "command", 0.0, False),  # a geared axis
        (0.01, 0.0, "command", 0.0, False),
        (0.0, 0.0, "command", 1.0, False),  # most of it follows something else
    ],
)
def test_a_commanded_effort_that_no_machine_would_ask_for_is_a_controllers_law(
    inertia, viscous, origin, other, doubted
):
    noise = 0.002 * np.random.default_rng(3).normal(size=5000)
    noise += other * np.sin(0.08 * np.arange(5000))

    def asked(q, v, a):
        return inertia * a + viscous * v + 0.7 * np.sin(q) + noise

    search = search_of(asked, origin=origin)
    chosen = search.models.fitted((LEVER["tip_payload"],), {})
    told = replace(chosen, left=np.full_like(chosen.left, 1e-3))  # by whatever law besides
    assert ("controller" in _computed(search, told)) is doubted
    assert _computed(search, search.models.fitted((), {})) == ""


def test_no_effect_is_smaller_than_what_a_noisy_sensor_leaves_and_makes_of_the_inertia():
    def asked(q, v, a):
        return 0.1 * a + 0.05 * v

    search = search_of(asked, noise=0.005)
    bare = search.models.fitted((), {})
    left, share = search.models.noise
    inertia = bare.fit.estimates["rig.inertia"].value
    assert 0.05 < share < 0.5
    assert inertia == pytest.approx(0.1 * (1.0 - share), rel=0.05)
    assert search.models.least == left == pytest.approx(np.std(bare.fit.residual), rel=0.1)
    assert "too small" in plausibility._by_noise(search, bare)[0]
    clean = search_of(asked)
    assert plausibility._by_noise(clean, clean.models.fitted((), {})) == []


def dragged(q, v, a):
    return 0.01 * a + 0.05 * v + 0.1 * np.tanh(v / 0.02)


def unwound(q, v, a):
    """The effort of a cable that its load unwinds, and that is slack on the way back."""
    return np.where(v < 0, 0.3 - 0.05 * v, 0.02)


@pytest.mark.parametrize(
    ("effort", "said"),
    [
        (lambda *m: np.abs(dragged(*m)), True),
        (lambda *m: -np.abs(dragged(*m)), True),
        (lambda *m: np.abs(dragged(*m) + 0.05), True),
        (dragged, False),
        (lambda *m: dragged(*m) + 1.0, False),  # a weight that holds its sign
        (lambda q, v, a: dragged(q, v, a) + 2.0 * np.cos(q), False),
        (lambda q, v, a: dragged(q, v, a) + 1.0 + 0.05 * v * (v > 0), False),
        (lambda q, v, a: dragged(q, v, a) + 1.0 + 0.1 * v * np.abs(v), False),
        (lambda q, v, a: 1.0 + 0.3 * np.sin(9 * q), False),
        (lambda q, v, a: 0.2 + np.exp(2 * q) + 0.05 * v, False),  # a spring that stiffens
        (lambda q, v, a: np.abs(np.random.default_rng(0).normal(size=len(q))), False),
        (unwound, False),
    ],
)
def test_an_effort_without_its_sign_is_told_only_where_that_of_the_speed_makes_it_fit(effort, said):
    search = search_of(effort)
    found = without_sign(search, search.models.fitted((), {}))
    assert found.endswith("was it logged without its sign?") == said
    assert bool(found) == said


def test_no_sign_is_missed_where_the_axis_moves_one_way_or_what_was_found_fits():
    search = search_of(lambda *motion: np.abs(dragged(*motion)))
    bare = search.models.fitted((), {})
    little = np.full_like(bare.left, 1e-6)
    assert without_sign(search, replace(bare, left=little))  # which no held-out log confirms
    assert without_sign(search, replace(bare, left=little, heldout=little)) == ""
    onward = search_of(lambda q, v, a: dragged(q, v + 6.0, a), onward=6.0)
    assert without_sign(onward, onward.models.fitted((), {})) == ""


@pytest.mark.parametrize(("held", "said"), [(dragged, True), (unwound, False)])
def test_held_out_logs_have_to_show_that_a_sign_is_missed(held, said):
    """They may have it themselves."""
    search = search_of(lambda *motion: np.abs(dragged(*motion)))
    search.models.heldout = search_of(held).models.train
    assert bool(without_sign(search, search.models.fitted((), {}))) == said


@pytest.mark.parametrize(
    ("low", "value", "high", "said"),
    [
        (0.01, 0.01, 0.7, []),  # at its bound, and not told
        (0.03, 0.035, 0.04, ["inertia comes out 0.04 times"]),
        (0.01, 0.01, 0.02, ["inertia comes out 0.02 times"]),
        (0.5, 30.0, 60.0, []),
        (0.0, 1e-17, 0.02, ["inertia comes out 0.02 times"]),
        (25.0, 30.0, 35.0, ["inertia comes out 25 times"]),
        (0.9, 1.0, 1.1, []),
    ],
)
def test_a_number_is_of_another_size_where_its_whole_interval_is(low, value, high, said):
    estimates = {"rig.inertia": Estimate(value, low, high, "kg·m²", False)}
    table = SimpleNamespace(about={"rig.inertia": SimpleNamespace(nominal=1.0)})
    models = SimpleNamespace(names=["rig.inertia"], train=SimpleNamespace(table=table))
    model = SimpleNamespace(fit=SimpleNamespace(estimates=estimates))
    found = _of_another_size(SimpleNamespace(models=models), model)
    assert [text.partition(" its")[0] for text in found] == said


def test_no_sign_is_blamed_where_what_was_found_explains_the_effort_as_logged():
    search = search_of(lambda q, v, a: -0.05 * v - 0.1 * np.tanh(v / 0.02))
    bare = search.models.fitted((), {})
    assert _turned(search, bare)
    little = np.full_like(bare.left, 1e-6)
    assert _turned(search, replace(bare, left=little, heldout=little)) == ""


def test_a_commanded_effort_may_answer_the_motion():
    search = search_of(lambda q, v, a: -2.0 * v - 5.0 * np.sin(q), origin="command")
    assert "unless a controller answers" in _turned(search, search.models.fitted((), {}))


def test_no_sign_is_blamed_where_hardly_anything_is_left_as_logged():
    """Moved by hand against a controller of a weight, an axis shows little that only resists."""
    search = search_of(lambda q, v, a: 2.0 * np.sin(q) - 0.001 * v)
    assert _turned(search, search.models.fitted((), {})) == ""


def test_what_held_out_logs_deny_shields_no_wrong_sign():
    search = search_of(lambda q, v, a: -0.05 * v - 0.1 * np.tanh(v / 0.02))
    bare = search.models.fitted((), {})
    fits = replace(bare, left=np.full_like(bare.left, 1e-6))
    assert "factor -1" in _turned(search, fits)


def test_what_is_not_likely_shields_no_wrong_sign():
    search = search_of(lambda q, v, a: -0.05 * v - 0.1 * np.tanh(v / 0.02))
    bare = search.models.fitted((), {})
    little = np.full_like(bare.left, 1e-6)
    fits = replace(bare, left=little, heldout=little)
    found = SimpleNamespace(chosen=fits, rungs=[bare, fits])
    rest = SimpleNamespace(left=little, heldout=little)
    assert doubts(search, found, rest) == []
    assert "factor -1" in doubts(search, found, rest, believed=False)[0]


@pytest.mark.parametrize(
    ("rate", "said"), [(0.1, "by +10.0% a second"), (-0.04, "by -4.0% a second")]
)
def test_an_effort_that_changes_with_time_is_told(rate, said):
    def drifted(q, v, a):
        return (0.01 * a + 0.05 * v) * (1.0 + rate * np.arange(0, 10, 2e-3))

    search = search_of(drifted)
    model = search.models.fitted((), {})
    train = search.models.train
    assert said in drifting(train, train, model, 0.001)[0]
    assert drifting(train, train, model, 1.0) == []  # less than counts


def test_a_constant_scale_is_no_drift():
    """What is left of a model that is three times too large is so at any time."""
    search = search_of(lambda q, v, a: 0.01 * a + 0.05 * v)
    train, model = search.models.train, search.models.fitted((), {})
    measured = train.measured()
    off = replace(model, fit=replace(model.fit, residual=2.0 * measured), heldout=2.0 * measured)
    assert drifting(train, train, off, 0.001) == []


def test_friction_that_a_model_lacks_is_no_drift():
    search = search_of(
        lambda q, v, a: 0.01 * a + 0.05 * v + 0.1 * np.tanh(v / 0.02) + 0.1 * v * abs(v)
    )
    train = search.models.train
    assert drifting(train, train, search.models.fitted((), {}), 0.001) == []


@pytest.mark.parametrize(
    ("kind", "left", "heldout", "said"),
    [
        ("unknown", 0.3, 0.9, True),
        ("named", 0.05, 0.9, True),  # the fitted logs leave less than the least that counts, 0.1
        ("undecided", 0.05, 0.9, True),
        ("named", 0.3, 0.9, False),
        ("nothing_missing", 0.05, 0.9, False),
        ("unknown", 0.3, 0.5, False),
        ("named", 0.01, 0.05, False),
    ],
)
def test_held_out_logs_that_show_more_are_told_where_that_may_bring_a_name(
    monkeypatch, kind, left, heldout, said
):
    monkeypatch.setattr(plausibility, "ways_apart", lambda train, heldout: False)
    models = SimpleNamespace(train=None, heldout=None)
    search = SimpleNamespace(models=models, worth=SimpleNamespace(least=0.1))
    chosen = SimpleNamespace(mean_square=left**2, heldout_square=heldout**2)
    told = untaught(search, chosen, SimpleNamespace(kind=kind, doubts=()))
    assert bool(told) == said


def noted(velocity=False, pace=1.0, left=0.0):
    """What is said beside a verdict of an axis in metres whose sensor of effort drifts.

    velocity  whether it is all that is logged of the motion;  pace  factor of the motion
    left      share of the effort that is left of data left out
    """
    t = np.arange(0, 10, 2e-3)
    v = pace * (3 * np.cos(3 * t) + 2.13 * np.cos(7.1 * t))
    u = v / pace * (1.0 + 0.05 * t)
    told = description(effort={"column": "u", "unit": "N", "kind": "force"})
    del told["position"]
    told |= {
        "velocity" if velocity else "position": {"column": "x", "unit": "m/s" if velocity else "m"}
    }
    rig = RigFile.model_validate(told)
    x = v if velocity else np.cumsum(v) * 2e-3
    logs = [prepare("log", {"t": t, "x": x, "u": u}, rig)]
    sizes = replace(SIZES, torque_unit="N", axis_unit="m")
    problem = InverseProblem(rig, None, logs, [], sizes, 0.02)
    search = Search(Models(problem, problem, ["rig.inertia", "rig.viscous"]), [], Criteria())
    model = replace(search.models.fitted((), {}), left=left * problem.measured())
    return " ".join(oddities(search, model, SimpleNamespace(condition=1.0), rig, fits=True))


@pytest.mark.parametrize(("velocity", "said"), [(True, False), (False, True)])
def test_a_unit_of_the_position_is_doubted_only_where_a_position_is_logged(velocity, said):
    assert ("The axis travels" in noted(velocity, pace=100.0)) == said


@pytest.mark.parametrize(("left", "said"), [(0.1, True), (0.9, False)])
def test_numbers_of_a_model_that_leaves_most_of_the_effort_are_not_told(left, said):
    assert ("sensor drift" in noted(left=left)) == said


def test_what_the_motion_explains_is_told_of_data_left_out():
    noise = np.random.default_rng(0).normal(size=5000)
    search = search_of(lambda q, v, a: noise)
    bare = search.models.fitted((), {})
    rest = SimpleNamespace(left=bare.left, heldout=bare.heldout)
    said = _senseless(search, SimpleNamespace(chosen=bare), rest)
    assert said.startswith("Of data left out the motion explains only 0% of the effort's variance")
    rest.heldout = 0.5 * bare.heldout  # of which it makes 75 %
    assert _senseless(search, SimpleNamespace(chosen=bare), rest) == ""
