"""Two explanations that the logs do not tell apart: the right one foretells a further trial."""

import json
from dataclasses import replace

import numpy as np
import pytest

from spirob.diagnosis import contest
from spirob.diagnosis.conclusion import Weighed, weigh
from spirob.diagnosis.contest import (
    Contestant,
    beside,
    decided_again,
    in_question,
    joined,
    proposed,
)
from spirob.diagnosis.proposals import TRIALS, propose, told
from spirob.diagnosis.verdict import Verdict, judge
from spirob.effects.motor.coulomb_friction import CoulombFriction
from spirob.effects.motor.load_dependent_friction import LoadDependentFriction
from spirob.trials import Trial
from tests.diagnosis.contested import SETTINGS, Robot
from tests.diagnosis.contested import beside as contested
from tests.diagnosis.machines import SAMPLES, Known, model

CONSTANT, GROWS = CoulombFriction, LoadDependentFriction
TRUE = {"coulomb_friction.coulomb_torque": 5e-4}
NUMBERS = {CONSTANT: next(iter(TRUE)), GROWS: "load_dependent_friction.loss_ratio"}


@pytest.fixture(scope="module")
def robot():
    return Robot(NUMBERS, TRUE)


@pytest.fixture(scope="module")
def ended(robot):
    """Friction that is constant, and friction that grows with the load."""
    return robot.ended()


@pytest.fixture(scope="module")
def best(ended):
    return proposed(ended, contested(ended))[0]


def models_of(ended):
    """As another process gets them."""
    models = in_question(ended, contested(ended))
    return [Contestant.from_dict(json.loads(json.dumps(one.as_dict()))) for one in models]


def named(ended, **beside):
    (effect,) = ended.found.chosen.effects
    return Verdict("named", {effect.name(): Weighed(0.99, 0.99, **beside)}, "", "", "")


def test_in_question_are_nothing_what_was_found_and_who_stands_beside_it(ended):
    bare, one, other = in_question(ended, contested(ended))
    assert bare == Contestant.of(ended.found.rungs[0])
    assert one == Contestant.of(ended.found.chosen)
    assert {*one.effects, *other.effects} == set(NUMBERS)
    assert models_of(ended) == [bare, one, other]


def test_experiments_are_ordered_by_what_they_would_show(ended, robot):
    found = proposed(ended, contested(ended))
    apart = [p.share for p in found]
    assert len(found) == len(TRIALS)
    assert apart == sorted(apart, reverse=True)
    assert apart[0] > 2.0 * apart[-1]
    for proposal in found:
        assert [Trial.from_plain(t).role for t in proposal.trials] == ["train", "validate"]
    line = told(found, robot.trials["validate"].effort)
    assert f"'{found[0].name}'" in line
    assert "mA" in line


def test_models_that_say_the_same_do_not_differ(ended, robot):
    same = ended.found.rungs[0].fit.changes
    assert max(p.difference for p in propose(robot.trials["validate"], same, same)) < 1e-3  # counts


def test_nothing_is_proposed_where_a_verdict_stands(ended):
    assert proposed(ended, named(ended)) == []
    assert in_question(ended, named(ended)) == in_question(ended, contested(ended))[:2]


def test_two_names_of_one_law_are_not_asked_about(robot):
    """The floor is more than any experiment could tell them apart by."""
    loose = robot.ended(settings=replace(SETTINGS, floor=10.0))
    assert proposed(loose, contested(loose)) == []


def test_a_name_beside_which_another_says_the_same_is_contested(ended):
    other = contested(ended).rivals
    same = named(ended, equivalents=other)
    assert in_question(ended, same) == in_question(ended, contested(ended))
    assert proposed(ended, same)


def test_who_was_never_fitted_in_the_place_of_what_was_found_is_not_in_question(ended):
    assert beside(ended, named(ended, equivalents=["creep"])) == []
    assert beside(ended, replace(contested(ended), kind="unknown")) == []


@pytest.mark.parametrize("right", NUMBERS, ids=["constant", "grows"])
def test_who_foretells_the_further_trial_wins(ended, robot, best, right):
    """Once the machine is the one rival, once the other: the further trial says which."""
    truth = TRUE if right is CONSTANT else robot.fits[(right,)].changes
    known = joined(robot.trials, robot.played(best, truth))
    for role in ("train", "validate"):
        assert len(known[role].trials) == len(robot.trials[role].trials) + 1
    assert known["heldout"] is robot.trials["heldout"]
    again = decided_again(models_of(ended), robot.trials, known, SETTINGS)
    chosen = again.found.chosen
    assert chosen.effects == (right,)
    assert again.found.offers[0].effect in NUMBERS
    # judged where the effect was found: what the further trial holds besides does not count
    verdict = judge(again, weigh(again))
    assert verdict.kind == "named" or right is GROWS, "the trials hold the other"
    validate = robot.trials["validate"]
    own = validate(chosen.fit.changes)[validate.rows]
    assert again.search.models.scores(chosen)["validate"].rmse == pytest.approx(
        np.sqrt(np.mean(own**2))
    )


def test_a_trial_that_nobody_explains_is_set_aside(ended, robot, best):
    """Something else happens there, ten times as large as what is in question."""
    rng, further = np.random.default_rng(1), {}
    for role, (log,) in robot.played(best).items():
        slow = np.cumsum(rng.standard_normal((len(log.current), 1)), axis=0) * 0.05
        further[role] = [replace(log, current=log.current + slow)]
    known = joined(robot.trials, further)
    assert decided_again(models_of(ended), robot.trials, known, SETTINGS) is None


@pytest.mark.parametrize(("before", "aside"), [("named", True), ("undecided", False)])
def test_a_further_trial_does_not_leave_open_what_was_named(
    ended, robot, monkeypatch, before, aside
):
    """Both foretell it about as well: of two that say the same where they were found one stands."""
    monkeypatch.setattr(contest, "judge", lambda *_: contested(ended))
    further = {role: robot.trials[role].trials[:1] for role in ("train", "validate")}
    known = joined(robot.trials, further)
    again = decided_again(models_of(ended), robot.trials, known, SETTINGS, before)
    assert (again is None) is aside


def settled(*others, alike=False):
    """A contest of friction that leaves 2 of 10 mA with others, by what each of them leaves."""
    errors = [0.002, *(error for _, error in others)]
    signs = [1.0] * len(errors) if alike else [1.0, *[-1.0] * len(others)]
    sets = [[CONSTANT], *(effects for effects, _ in others)]
    made = [
        model(effects, error, residual=np.full(SAMPLES, sign * error))
        for effects, error, sign in zip(sets, errors, signs, strict=True)
    ]
    machines = [Known(model([], 0.010), *made, least=0.001) for _ in range(2)]
    found = contest.settled(*machines, SETTINGS).found
    assert found.chosen.effects == (CONSTANT,)
    return found.rivals[CONSTANT.name()], found.equivalents[CONSTANT.name()]


@pytest.mark.parametrize(
    ("left", "rivals"),
    [(0.00201, [GROWS.name()]), (0.0030, []), (0.00999, [])],
    ids=["as well", "clearly worse", "nothing"],
)
def test_who_counts_and_is_not_clearly_worse_is_a_rival(left, rivals):
    assert settled(([GROWS], left)) == (rivals, [])


def test_who_says_the_same_where_it_is_settled_is_an_equivalent():
    assert settled(([GROWS], 0.00201), alike=True) == ([], [GROWS.name()])


def test_what_holds_the_found_and_more_is_no_rival():
    """It was left for being hardly better."""
    assert settled(([CONSTANT, GROWS], 0.00199)) == ([], [])
