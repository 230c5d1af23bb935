"""A name has to hold on the held-out trials, which had no part in finding it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spirob.diagnosis.rungs import Confirmed, Ladder, Rung, Settings
from spirob.diagnosis.verdict import foretold, judge
from spirob.effects import find_effects
from spirob.identify.fit import Fit
from spirob.identify.problem import Effort
from spirob.score import Score

SETTINGS = Settings()
EFFECT = find_effects(["capstan_friction"])
FIT = Fit({}, {}, np.full(100, 0.002), np.zeros((0, 0)), 0.0, 0)
# of an effort of 1 A without noise: the floor is 3 mA
TRIALS = SimpleNamespace(
    measured=lambda: np.ones(100),
    rows=np.ones(100, dtype=bool),
    edges=np.array([0, 100]),
    block=50,
    raw=lambda: [np.ones(100)],
    filter=lambda values: values,
    effort=Effort("motor current", "A"),
)
PROBLEMS = dict.fromkeys(("train", "validate", "heldout"), TRIALS)


def rung(effects, validate, heldout):
    scores = {r: Score(e, e, 0.9) for r, e in (("validate", validate), ("heldout", heldout))}
    scores["train"] = scores["validate"]
    return Rung("", effects, FIT, scores, np.full(20, validate**2))


def search(heldout, before=0.010):
    """Found on validation trials, 10 -> 2 mA; on the held-out ones from `before` to `heldout`."""
    base, last = rung([], 0.010, before), rung(EFFECT, 0.002, heldout)
    found = Confirmed(tuple(EFFECT), 0.9, FIT, np.zeros(100), last.errors, last.scores, 1.0)
    return Ladder(base, [base, last], [[found]])


def test_a_name_that_holds_on_held_out_trials_is_named():
    assert judge(search(0.002), PROBLEMS, SETTINGS).kind == "named"


@pytest.mark.parametrize("heldout", [0.006, 0.010, 0.02])
def test_a_name_that_does_not_is_unknown(heldout):
    verdict = judge(search(heldout), PROBLEMS, SETTINGS)
    assert verdict.kind == "unknown"
    assert EFFECT[0].title in verdict.explanation


def test_the_share_is_of_what_lies_above_the_floor():
    share = (0.010**2 - 0.006**2) / (0.010**2 - 0.003**2)
    assert foretold(search(0.006), TRIALS, SETTINGS) == pytest.approx(share)
    half = replace(SETTINGS, floor=0.0)
    assert foretold(search(0.005), TRIALS, half) == pytest.approx(0.75)


def test_a_model_that_is_complete_on_held_out_trials_takes_no_name_away():
    """Also where they hardly show the effect."""
    assert foretold(search(0.0029, before=0.0031), TRIALS, SETTINGS) == 1.0
    assert judge(search(0.0029, before=0.0029), PROBLEMS, SETTINGS).kind == "named"


def test_held_out_trials_give_no_name():
    """However well they are met: what decides are the validation trials."""
    poor = search(0.001)
    poor.rungs[-1] = replace(poor.rungs[-1], errors=np.full(20, 0.008**2))
    assert judge(poor, PROBLEMS, SETTINGS).kind == "unknown"


@pytest.mark.parametrize("later", [False, True])
def test_a_probability_is_that_of_one_contest(later):
    """Two that say the same share theirs; what won another round with others adds nothing."""
    other = find_effects(["coulomb_friction"])
    found = search(0.002)
    (best,) = found.rounds[0]
    twin = replace(best, effects=tuple(other), probability=0.3)
    if later:
        both = [*other, *EFFECT]
        found.rungs.append(replace(found.rungs[-1], effects=both))
        found.rounds = [[twin], [replace(best, probability=0.8)]]
    else:
        found.rounds = [[replace(best, probability=0.5), twin]]
    verdict = judge(found, PROBLEMS, SETTINGS)
    assert verdict.probability == pytest.approx(0.8 * verdict.accounted)


@pytest.mark.parametrize(("left", "kind"), [(0.0029, "named"), (0.0035, "unknown")])
def test_only_what_leaves_structure_has_to_win_more(left, kind):
    """Within what builds of one machine differ by, nothing is left that another law could be in."""
    found = search(0.002)
    found.rungs[-1] = replace(found.rungs[-1], errors=np.full(20, left**2))
    found.rounds = [[replace(found.rounds[0][0], probability=0.75)]]
    verdict = judge(found, PROBLEMS, SETTINGS)
    assert verdict.kind == kind
    if kind == "named":  # though not so sure of it
        assert verdict.probability == pytest.approx(0.75 * (1 - (left / 0.010) ** 2), rel=1e-3)


@pytest.mark.parametrize(("beside", "kind"), [(EFFECT, "named"), ([], "undecided")])
def test_what_holds_the_name_and_more_is_no_rival(beside, kind):
    """Two effects of which one was not needed say the name that is left, as often as they win."""
    other = find_effects(["coulomb_friction"])
    found = search(0.002)
    one = replace(found.rounds[0][0], probability=0.1)
    both = replace(one, effects=(*other, *beside), probability=0.9, missed=np.full(100, 0.01))
    found.rounds = [[both, one]]
    verdict = judge(found, PROBLEMS, SETTINGS)
    assert verdict.kind == kind
    if kind == "named":
        assert verdict.probability == pytest.approx(verdict.accounted)
        assert verdict.equivalents == ()
