"""The delay between effort and motion is found beside whatever else is missing of the model."""

import numpy as np
import pytest

from spirob.effects import all_effects
from spirob.errors import DataError
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import Sizes
from spirob.machine.recordings.recording import prepare
from spirob.machine.search import delays
from spirob.machine.search.delays import partnered, place, usual, valley
from spirob.machine.search.models import Models
from tests.machine.rigs import description

SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")
W = 2 * np.pi * 0.7
REST = 0.02


def motion(t):
    return np.sin(W * t) + 0.3 * np.sin(3.7 * W * t)


def speed(t):
    return W * np.cos(W * t) + 1.11 * W * np.cos(3.7 * W * t)


def none(t):
    return 0.0 * t


def wave(t):
    return 0.3 * np.sin(20 * motion(t))


def dry(t):
    return 0.3 * np.tanh(speed(t) / REST)


def weight(t):
    return 0.5 * np.cos(motion(t))


def placed(lag, hidden, period=2e-3):
    """Where effort and motion of a swinging axis lie, whose effort trails by `lag` [s]."""

    def effort(t):
        faster = -(W**2) * (np.sin(W * t) + 4.107 * np.sin(3.7 * W * t))
        return 0.1 * speed(t) + 0.03 * faster + sum(law(t) for law in hidden)

    return found_in(lambda t: effort(t - lag), period)


def found_in(effort, period=2e-3, rows=None):
    """The same for any effort, of the first rows of the log."""
    t = np.arange(0, 8, period)
    told = description(filter={"cutoff": 0.08 / period}, known={"delay": 0.0})
    rig = RigFile.model_validate(told)
    log = prepare("log", {"t": t, "q": motion(t), "u": effort(t)}, rig)
    if rows:
        log.pieces[0].use[rows:] = False
    effects = [all_effects()[name] for name in ("cogging", "presliding_friction")]
    problem = InverseProblem(rig, None, [log], effects, SIZES, REST)
    models = Models(problem, problem, [f"rig.{n}" for n in rig.fit])
    return place(problem, models.fitted((), {}), models.folds, effects)


@pytest.mark.parametrize("hidden", [[none], [wave], [dry, weight], [wave, dry]])
@pytest.mark.parametrize("lag", [-45e-3, -2e-3, 0.0, 17e-3, 50e-3])
def test_a_delay_is_found_beside_laws_that_are_missing(lag, hidden):
    found = placed(lag, hidden)
    assert found.nominal == pytest.approx(lag, abs=0.5 * usual(2e-3))
    assert found.low < lag < found.high


@pytest.mark.parametrize("lag", [0.03, 0.05])
@pytest.mark.parametrize("period", [1e-3, 5e-3, 10e-3, 20e-3])
def test_it_is_found_at_any_rate(period, lag):
    """At 100 Hz 50 ms lie a row from the farthest place, which only what is beyond tells."""
    found = placed(lag, [dry, weight], period)
    assert found.low <= lag <= found.high
    assert abs(found.nominal - lag) < usual(period)


@pytest.mark.parametrize(
    ("left", "place"),
    [
        ([9, 8, 7, 6, 5, 4, 3, 2, 1], (8, 8, 8)),  # sharp, far
        ([1.0, 2, 3, 2, 1.02, 2, 3, 2, 2], (4, 4, 4)),  # a usual one that leaves hardly more
        ([1.0, 2, 3, 2, 1.5, 2, 3, 2, 2], (0, 0, 0)),
        ([3, 3, 1.01, 1.0, 1.05, 1.05, 2, 2, 2], (3, 2, 5)),  # flat: all that it may be
        ([1.0] * 9, (3, 0, 8)),
    ],
)
def test_a_place_and_how_far_about_it_the_delay_may_lie(left, place):
    among = np.abs(np.arange(9) - 4) <= 1
    assert valley(np.array(left, float), among) == place


def test_too_few_rows_tell_no_delay():
    found = found_in(lambda t: speed(t - 0.03), 20e-3, rows=60)
    most = usual(20e-3)
    assert (found.low, found.nominal, found.high) == (-most, 0.0, most)


@pytest.mark.parametrize("period", [2.0004e-3, 2.0012e-3, 2.0026e-3])
def test_a_place_that_is_usual_but_for_rounding_is_usual(monkeypatch, period):
    """Three thirds of the usual delay are more than it by 4e-19 s."""
    monkeypatch.setattr(delays, "valley", lambda left, usual: (32, 32, 33))
    assert placed(0.0, [none], period).low == pytest.approx(-usual(period), abs=1e-9)


@pytest.mark.parametrize(
    ("where", "bounds"),
    [
        ((29, 21, 33), (-3, 3)),  # flat, with the usual ones in it
        ((29, 28, 30), (-3, 3)),
        ((26, 26, 29), (-4, 3)),  # at the end of what is usual it may lie a step beyond
        ((29, 0, 33), (-3, 3)),  # no end to one side: told by nothing
        ((0, 0, 9), (-3, 3)),  # the best one may lie farther
        ((11, 5, 13), (-27, -13)),
        ((2, 1, 13), (-31, -13)),
    ],
)
def test_bounds_hold_what_is_usual_or_all_that_leave_hardly_more(monkeypatch, where, bounds):
    monkeypatch.setattr(delays, "valley", lambda left, usual: where)
    found, step = placed(0.0, [none], 2e-3), usual(2e-3) / 3
    assert (found.low / step, found.high / step) == pytest.approx(bounds, abs=1e-4)


@pytest.mark.parametrize(
    ("told", "odd"),
    [
        ({}, False),
        ({"known": {"delay": 0.05}}, False),
        ({"known": {"delay": -12.0}}, True),
        ({"fit": {"delay": {"nominal": 0.0, "low": -0.02, "high": 3.0}}}, True),
    ],
)
def test_a_delay_by_which_the_motion_turns_is_told(told, odd):
    t = np.arange(0.0, 8.0, 5e-3)
    described = RigFile.model_validate(description(**told))
    made = prepare("log", {"t": t, "q": motion(t), "u": speed(t)}, described)
    said = delays.strange(described, [made])
    assert len(said) == odd
    assert all("is it in seconds?" in sentence for sentence in said)


def test_a_known_delay_that_leaves_no_row_a_partner_is_refused():
    t = np.arange(0, 10, 0.01)
    columns = {"t": t, "q": motion(t), "u": speed(t)}
    for delay in (1.0, -30.0):
        rig = RigFile.model_validate(description(known={"delay": delay}))
        logs = [prepare("log", columns, rig)]
        if delay > 0.0:
            assert partnered(rig, logs)[0].pieces
            continue
        with pytest.raises(DataError, match=r"known\.delay: -30 s leave no row .* in seconds"):
            partnered(rig, logs)
