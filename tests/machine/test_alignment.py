"""No log is aligned to better than a sample, and a smoothed model is no lag."""

from types import SimpleNamespace

import numpy as np
import pytest

from spirob.effects import all_effects
from spirob.machine.description.rig import Bounded, RigFile
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import Sizes
from spirob.machine.recordings.recording import prepare
from spirob.machine.search.delays import (
    FARTHEST,
    inside,
    is_told,
    only_aligns,
    only_smoothing,
    partnered,
    usual,
)
from spirob.machine.search.models import Models
from tests.machine.rigs import description

SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")
W = 2 * np.pi * 0.7
TRUE = {"rig.inertia": 0.03, "rig.viscous": 0.1}


def models(lag, effects=(), period=2e-3):
    """A swinging axis whose effort trails its motion by `lag` [s], which is fitted about that."""
    t = np.arange(0, 8, period)
    q = np.sin(W * t) + 0.3 * np.sin(3.7 * W * t)

    def effort(t):
        v = W * np.cos(W * t) + 1.11 * W * np.cos(3.7 * W * t)
        return 0.1 * v - 0.03 * W**2 * (np.sin(W * t) + 4.107 * np.sin(3.7 * W * t))

    rig = RigFile.model_validate(description(filter={"cutoff": 40.0}))
    most = usual(period)
    fitted = Bounded(nominal=lag, low=lag - most, high=lag + most)
    rig = rig.model_copy(update={"fit": {**rig.fit, "delay": fitted}})
    log = prepare("log", {"t": t, "q": q, "u": effort(t - lag)}, rig)
    chosen = [all_effects()[name] for name in effects]
    problem = InverseProblem(rig, None, partnered(rig, [log]), chosen, SIZES, 0.02)
    return Models(problem, problem, [f"rig.{n}" for n in rig.fit]), rig


@pytest.mark.parametrize("lag", [-50e-3, -12e-3, -2e-3, 0.0, 1.3e-3, 9e-3, 33.3e-3, 57e-3])
def test_the_delay_of_a_log_is_fitted(lag):
    made, _ = models(lag)
    changes = made.fitted((), {}).fit.changes
    assert changes["rig.delay"] == pytest.approx(lag, abs=5e-5)
    assert changes["rig.inertia"] == pytest.approx(0.03, rel=0.01)


@pytest.mark.parametrize(
    ("told", "is_so"),
    [({"known": {"delay": 0.0}}, True), ({}, False)],
)
def test_a_delay_that_is_given_is_told(told, is_so):
    assert is_told(RigFile.model_validate(description(**told))) == is_so


def test_rows_without_a_partner_are_not_compared():
    rig = RigFile.model_validate(description(known={"delay": -0.04}))
    log = log_of(rig)
    (cut,) = partnered(rig, [log])
    ends = round(0.04 / log.period)
    before, after = log.pieces[0].use, cut.pieces[0].use
    assert not after[:ends].any()
    assert not after[-ends:].any()
    np.testing.assert_array_equal(after[ends:-ends], before[ends:-ends])


def test_a_log_that_a_delay_leaves_nothing_of_is_compared_whole():
    rig = RigFile.model_validate(description(known={"delay": 4.0}))
    log, longer = log_of(rig), log_of(rig, 20.0)
    assert inside(log, FARTHEST).pieces
    assert not inside(log, 4.0).pieces
    assert inside(longer, 4.0).pieces
    assert partnered(rig, [log, longer])[0] is log


def log_of(rig, seconds=8.0):
    t = np.arange(0, seconds, 2e-3)
    return prepare("log", {"t": t, "q": np.sin(W * t), "u": np.cos(W * t)}, rig)


@pytest.mark.parametrize(
    ("age", "delay", "no_more"),
    [(0.010, 0.0, False), (0.010, -0.005, True), (0.001, 0.0, True), (0.030, -0.045, True)],
)
@pytest.mark.parametrize("place", [0.0, 0.040])
def test_a_lag_counts_from_where_alignment_ends(age, delay, no_more, place):
    _, rig = models(place)
    changes = {"current_lag.time": age, "rig.delay": place + delay}
    lagging = SimpleNamespace(
        effects=(all_effects()["current_lag"],), fit=SimpleNamespace(changes=changes)
    )
    assert only_aligns(lagging, rig, 2e-3) == no_more


@pytest.mark.parametrize(("delay", "undone"), [(-0.019, True), (0.0, False), (0.019, False)])
def test_a_lag_that_a_delay_undoes_only_smooths_wherever_that_was_placed(delay, undone):
    """It is looked for about 15 ms before the motion; the two together make 4 ms."""
    _, rig = models(-0.015)
    lag = all_effects()["current_lag"]
    changes = {"current_lag.time": 0.023, "rig.delay": delay}
    lagging = SimpleNamespace(effects=(lag,), fit=SimpleNamespace(changes=changes))
    assert only_smoothing(lagging, rig, 2e-3) == ({"current_lag"} if undone else set())


@pytest.mark.parametrize("delay", [-0.04, 0.0, 0.025])
@pytest.mark.parametrize("latency", [0.003, 0.007])
def test_a_latency_adds_to_the_delay_of_a_log(latency, delay):
    """A frame that is old when it arrives, and a channel that is logged late: both only shift."""
    made, _ = models(delay - latency, ["feedback_latency"], period=1e-3)
    given = {"rig.delay": delay, "feedback_latency.latency": latency}
    both = made.train(TRUE | given)
    one = made.train(TRUE | {"rig.delay": delay - latency})
    size = made.size
    assert np.sqrt(np.mean(both**2)) < 2e-3 * size
    assert np.sqrt(np.mean((both - one) ** 2)) < 2e-3 * size
