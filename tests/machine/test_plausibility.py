"""Logs that do not belong together are seen before a name is believed."""

import re

import numpy as np
import pytest

from spirob.diagnosis.criteria import Criteria
from spirob.diagnosis.search import Search
from spirob.machine.inverse import InverseProblem
from spirob.machine.models import Models
from spirob.machine.plausibility import _mended, _turned, odd_one_out, strangers
from spirob.machine.recording import prepare
from spirob.machine.rig import RigFile
from spirob.machine.scaling import Sizes
from tests.machine.rigs import description

SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")


def problem(*factors):
    """Logs of one axis, whose effort is so many times the true one."""
    rig, logs = RigFile.model_validate(description()), []
    for k, factor in enumerate(factors):
        t = np.arange(0, 6, 2e-3)
        w = 4.0 + k
        effort = 0.01 * -(w**2) * np.sin(w * t) + 0.3 * w * np.cos(w * t)
        made = {"t": t, "q": np.sin(w * t), "u": factor * effort}
        logs.append(prepare(f"log{k}", made, rig))
    return InverseProblem(rig, None, logs, [], SIZES, 0.02)


@pytest.mark.parametrize(("signs", "strange"), [((1, 1, 1), ""), ((1, -1, 1), "log1")])
def test_a_log_of_another_motor_is_named(signs, strange):
    made = problem(*signs)
    said = strangers([made], [made({"rig.inertia": 0.01, "rig.viscous": 0.3})])
    assert said.partition(":")[0] == strange


def half_turned(t):
    """A sign that turns in the middle of a log."""
    return np.where(t < 3.0, 1.0, -1.0)


@pytest.mark.parametrize(
    ("factors", "odd"),
    [
        ((1, 3, 1), "log1: .*; as 3 times the model, 100% of the variance is explained"),
        ((1, 1, -1), "log2: .*; with its effort's sign turned 100% of the variance"),
        ((half_turned(np.arange(0, 6, 2e-3)), 1, 1), "log0: [^;]*$"),
        ((1, 1, 1), None),
        ((1, 3), None),
        ((1, 3, 9), None),
    ],
)
def test_the_log_without_which_all_others_fit_is_named(factors, odd):
    made = problem(*factors)
    nothing = odd_one_out([made], [-0.9 * made.measured()])
    assert re.match(odd, nothing) if odd else nothing == ""
    assert odd_one_out([made], [0.1 * made.measured()]) == ""  # the model fits all of them


def search_of(effort):
    """A search over one log of an axis with inertia, friction and a weight."""
    rig = RigFile.model_validate(description())
    t = np.arange(0, 10, 2e-3)
    q, v = np.sin(3 * t) + 0.3 * np.sin(7.1 * t), 3 * np.cos(3 * t) + 2.13 * np.cos(7.1 * t)
    a = -9 * np.sin(3 * t) - 15.1 * np.sin(7.1 * t)
    made = [prepare("log", {"t": t, "q": q, "u": effort(q, v, a)}, rig)]
    problem = InverseProblem(rig, None, made, [], SIZES, 0.02)
    return Search(Models(problem, problem, ["rig.inertia", "rig.viscous"]), [], Criteria())


def test_a_sign_is_blamed_only_where_turning_it_makes_the_model_fit():
    def resisting(q, v, a):
        return 0.01 * a + 0.05 * v + 0.1 * np.tanh(v / 0.02) + 0.2 * np.sin(q)

    assert _turned(search_of(resisting)) == ""
    said = _turned(search_of(lambda *motion: -resisting(*motion)))
    assert "factor -1" in said
    assert "100%" in said
    noise = np.random.default_rng(0).normal(size=5000)
    assert _turned(search_of(lambda q, v, a: noise)) == ""


def test_what_mends_a_strange_log_is_said_with_its_share():
    modelled = np.sin(np.arange(1000) / 30)
    assert "sign turned 100%" in _mended(-modelled, modelled)
    assert "an offset of 3" in _mended(modelled + 3.0, modelled)
    assert "as 5 times the model" in _mended(5.0 * modelled, modelled)
    assert _mended(np.random.default_rng(0).normal(size=1000), modelled) == ""
