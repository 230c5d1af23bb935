"""A name is given where such names were right; trials that had no part in it say most."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from spirob.diagnosis.rungs import Confirmed, Ladder, Rung, Settings

from spirob.diagnosis import ladder
from spirob.diagnosis.certainty import LIKELY, MOST, probability
from spirob.diagnosis.figures import weighed
from spirob.diagnosis.verdict import judge
from spirob.effects import find_effects
from spirob.identify.fit import Estimate, Fit
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


def fit_of(value=1.0, half=0.05):
    """A fit of the effect's amplitude with its interval."""
    one = Estimate(value, value - half, value + half, "1", False)
    return replace(FIT, estimates={f"{EFFECT[0].name()}.friction": one})


def rung(effects, validate, heldout, found=FIT):
    scores = {r: Score(e, e, 0.9) for r, e in (("validate", validate), ("heldout", heldout))}
    scores["train"] = scores["validate"]
    return Rung("", effects, found, scores, np.full(20, validate**2))


def search(heldout, before=0.010, found=None):
    """Found on validation trials, 10 -> 2 mA; on the held-out ones from `before` to `heldout`."""
    found = found or fit_of()
    base, last = rung([], 0.010, before), rung(EFFECT, 0.002, heldout, found)
    best = Confirmed(tuple(EFFECT), 0.9, found, np.zeros(100), last.errors, last.scores, 1.0)
    return Ladder(base, [base, last], [[best]])


def sure(found, settings=SETTINGS):
    return weighed(found, PROBLEMS, settings)[EFFECT[0].name()].probability


def test_a_name_that_holds_on_held_out_trials_is_named():
    verdict = judge(search(0.002), PROBLEMS, SETTINGS)
    assert verdict.kind == "named"
    assert verdict.probability == sure(search(0.002)) >= LIKELY


@pytest.mark.parametrize("heldout", [0.010, 0.02])
def test_a_name_that_does_not_is_unknown(heldout):
    verdict = judge(search(heldout), PROBLEMS, SETTINGS)
    assert verdict.kind == "unknown"
    assert EFFECT[0].title in verdict.explanation
    assert f"({sure(search(heldout)):.0%})" in verdict.explanation  # how unlikely it is, is said


def test_the_more_a_name_leaves_the_less_likely_it_is():
    told = [sure(search(heldout)) for heldout in (0.002, 0.004, 0.006, 0.008, 0.010)]
    assert told == sorted(told, reverse=True)
    assert told[0] > LIKELY > told[-1]


def test_figures_are_of_the_held_out_errors():
    """What is left counts above the floor alone: so much do builds of the machine differ by."""
    shown = weighed(search(0.006), PROBLEMS, SETTINGS)[EFFECT[0].name()].figures
    fall = np.log((0.010 / 0.006) ** 2)
    assert shown["fall_heldout"] == pytest.approx(fall, rel=1e-5)
    assert shown["ahead_heldout"] == pytest.approx(fall, rel=1e-5)  # none was tried besides
    left = np.log((0.006**2 - 0.003**2) / (0.010**2 - 0.006**2))
    assert shown["left"] == pytest.approx(left, rel=1e-5)
    complete = weighed(search(0.0029), PROBLEMS, SETTINGS)[EFFECT[0].name()].figures
    assert complete["left"] == -MOST


def test_another_that_does_as_well_on_held_out_trials_makes_it_less_likely():
    other = find_effects(["coulomb_friction"])
    found = search(0.002)
    scores = {**found.rungs[-1].scores, "heldout": Score(0.0035, 0.0035, 0.9)}
    far = replace(
        found.rounds[0][0], effects=tuple(other), missed=np.full(100, 0.01), scores=scores
    )
    found.rounds = [[found.rounds[0][0], replace(far, probability=0.0)]]
    assert sure(found) < sure(search(0.002))
    twin = replace(far, missed=np.zeros(100))  # what says the same is no other
    found.rounds = [[found.rounds[0][0], twin]]
    assert sure(found) == sure(search(0.002))


def test_the_sharper_its_number_the_surer_a_name():
    vague, clear = (sure(search(0.003, found=fit_of(half=half))) for half in (0.8, 0.02))
    assert vague < clear


def added(*rungs):
    """A ladder of these rungs above the fitted numbers alone, with what was tried beside each."""
    found = search(0.002)
    tried = [
        [replace(found.rounds[0][0], effects=(r.effects[-1],), scores=r.scores, errors=r.errors)]
        for r in rungs
    ]
    return Ladder(found.base, [found.base, *rungs], tried)


@pytest.mark.parametrize(("second", "kind"), [(0.0019, "unknown"), (0.0001, "named")])
def test_of_several_the_least_sure_one_decides(second, kind):
    """Each is as sure as its own figures say; one that is unlikely withholds the name of all."""
    other = find_effects(["coulomb_friction"])
    both = added(
        rung(EFFECT, 0.002, 0.002, fit_of()), rung([*EFFECT, *other], 0.002, second, fit_of())
    )
    told = weighed(both, PROBLEMS, SETTINGS)
    assert [w.figures["place"] for w in told.values()] == [0.0, 1.0]
    verdict = judge(both, PROBLEMS, SETTINGS)
    assert verdict.kind == kind
    least = min(w.probability for w in told.values())
    assert verdict.probability == (least if kind == "named" else 0.0)
    own = verdict.evidence[EFFECT[0].name()]
    assert own["probability"] == probability(own["figures"])


def test_an_effect_that_made_another_needless_is_weighed_against_the_model_without_both():
    other = find_effects(["coulomb_friction"])
    first, last = rung(other, 0.004, 0.004), rung(EFFECT, 0.0038, 0.0038, fit_of())
    told = weighed(added(first, last), PROBLEMS, SETTINGS)
    (own,) = told.values()
    assert own.figures["fall_heldout"] == pytest.approx(2 * np.log(0.010 / 0.0038), rel=1e-5)
    assert own.figures["place"] == 0.0
    kept = added(first, last)
    ladder._without_unlikely(kept, PROBLEMS, SETTINGS)
    assert kept.rungs[-1] is last  # what is not needed does not come back


def test_an_unlikely_second_effect_is_taken_away():
    other = find_effects(["coulomb_friction"])
    first = rung(EFFECT, 0.002, 0.002, fit_of())
    both = added(first, rung([*EFFECT, *other], 0.002, 0.0019, fit_of()))
    ladder._without_unlikely(both, PROBLEMS, SETTINGS)
    assert both.rungs[-1] is first


def test_what_is_left_beside_a_name_is_said():
    found = search(0.002)
    assert "Beside it" not in judge(found, PROBLEMS, SETTINGS).explanation
    scores = {**found.rungs[-1].scores, "validate": Score(0.004, 0.004, 0.9)}
    found.rungs[-1] = replace(found.rungs[-1], scores=scores)
    verdict = judge(found, PROBLEMS, SETTINGS)
    assert verdict.kind == "named"
    assert "Beside it 0.4% of the motor current is left" in verdict.explanation


@pytest.mark.parametrize(("beside", "kind"), [(EFFECT, "named"), ([], "undecided")])
def test_what_holds_the_name_and_more_is_no_rival(beside, kind):
    """Two effects of which one was not needed say the name that is left."""
    other = find_effects(["coulomb_friction"])
    found = search(0.002)
    one = replace(found.rounds[0][0], probability=0.1)
    rest = {**one.scores, "heldout": Score(0.009, 0.009, 0.9)}
    both = replace(
        one, effects=(*other, *beside), probability=0.9, missed=np.full(100, 0.01), scores=rest
    )
    found.rounds = [[both, one]]
    verdict = judge(found, PROBLEMS, SETTINGS)
    assert verdict.kind == kind
    if kind == "named":
        assert verdict.equivalents == ()
