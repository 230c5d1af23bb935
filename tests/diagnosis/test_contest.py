"""Two explanations that the logs do not tell apart: the right one foretells a further trial."""

import json
from dataclasses import replace

import numpy as np
import pytest
from spirob.diagnosis.rungs import Confirmed, Ladder, Rung, Settings, rung_of, scores_of
from spirob.diagnosis.weighing import with_probability

from spirob.diagnosis.contest import (
    Contestant,
    contest,
    contestants,
    decided_again,
    joined,
    proposed,
)
from spirob.diagnosis.proposals import TRIALS, propose, told
from spirob.diagnosis.verdict import Verdict, judge
from spirob.effects.motor.coulomb_friction import CoulombFriction
from spirob.effects.motor.load_dependent_friction import LoadDependentFriction
from spirob.identify.fit import fit
from spirob.identify.measurement import Measurement
from spirob.trials import Trial
from spirob.trials.simulation import simulate
from tests.identify.known import residual, spirob

TRUE = {"coulomb_friction.coulomb_torque": 5e-4}
OTHER = "load_dependent_friction.loss_ratio"
SETTINGS = Settings()


@pytest.fixture(scope="module")
def plant():
    return spirob([CoulombFriction, LoadDependentFriction])


@pytest.fixture(scope="module")
def trials(plant):
    return {r: residual(plant, TRUE, r, seed=3) for r in ("train", "validate", "heldout")}


@pytest.fixture(scope="module")
def search(trials):
    """As if the first round had ended: friction that is constant, and that grows with the load."""
    train = trials["train"]
    base = rung_of("fitted parameters", [], fit(train, ["winch.efficiency"], {}, 0.05), trials)
    tried = []
    for effect, name in ((CoulombFriction, next(iter(TRUE))), (LoadDependentFriction, OTHER)):
        found = fit(train, ["winch.efficiency", name], {}, 0.05)
        scores, missed, errors = scores_of(found, trials)
        tried.append(Confirmed((effect,), 0.0, found, missed, errors, scores))
    tried = with_probability(tried, base, train, SETTINGS)
    best = tried[0]
    rung = Rung("+ one", list(best.effects), best.fit, best.scores, best.errors)
    return Ladder(base, [base, rung], [tried])


def undecided(search):
    other = search.rounds[0][1].effects[0].name()
    return Verdict("undecided", 0.5, [other], "", "", "")


def test_the_rivals_are_the_best_and_who_stands_against_it(search):
    one, other = contestants(search, undecided(search))
    assert {*one.effects, *other.effects} == {CoulombFriction, LoadDependentFriction}
    assert list(one.effects) == search.rungs[-1].effects


def test_experiments_are_ordered_by_what_they_would_show(search, trials):
    found = proposed(search, undecided(search), trials["validate"], SETTINGS)
    apart = [p.share for p in found]
    assert len(found) == len(TRIALS)
    assert apart == sorted(apart, reverse=True)
    assert apart[0] > 2.0 * apart[-1]
    for proposal in found:
        assert [Trial.from_plain(t).role for t in proposal.trials] == ["train", "validate"]
    line = told(found, trials["validate"].effort)
    assert f"'{found[0].name}'" in line
    assert "mA" in line


def test_models_that_say_the_same_do_not_differ(trials, search):
    same = search.rungs[0].fit.changes
    assert max(p.difference for p in propose(trials["validate"], same, same)) < 1e-3  # a count


def test_nothing_is_proposed_where_a_verdict_stands(search, trials):
    named = Verdict("named", 0.99, [], "", "", "")
    assert proposed(search, named, trials["validate"], SETTINGS) == []


def test_two_names_of_one_law_are_not_asked_about(search, trials):
    loose = replace(SETTINGS, floor=10.0)  # more than any experiment could tell them apart by
    assert proposed(search, undecided(search), trials["validate"], loose) == []


def test_a_name_beside_which_another_says_the_same_is_contested(search, trials):
    other = search.rounds[0][1].effects[0].name()
    named = Verdict("named", 0.99, [], "", "", "", equivalents=(other,))
    assert contestants(search, named) == contestants(search, undecided(search))
    assert proposed(search, named, trials["validate"], SETTINGS)


def test_with_more_added_since_the_first_round_is_not_in_question(search, trials):
    further = Ladder(search.base, list(search.rungs), search.rounds)
    both = [CoulombFriction, LoadDependentFriction]
    further.rungs.append(Rung("+ both", both, *[None] * 3))
    assert proposed(further, undecided(search), trials["validate"], SETTINGS) == []


@pytest.mark.parametrize(
    ("truth", "right"),
    [(TRUE, CoulombFriction), (None, LoadDependentFriction)],
    ids=["constant", "grows"],
)
def test_who_foretells_the_further_trial_wins(search, trials, plant, truth, right):
    """Once the machine is the one rival, once the other: the further trial says which."""
    one = next(c for c in search.rounds[0] if c.effects == (right,))
    best = proposed(search, undecided(search), trials["validate"], SETTINGS)[0]
    played = [
        simulate(plant, Trial.from_plain(t), truth or one.fit.changes, 0.002, seed=k)
        for k, t in enumerate(best.trials)
    ]
    logs = [Measurement.from_trace(trace) for trace in played]
    known = joined(trials, {r: [log] for r, log in zip(("train", "validate"), logs, strict=True)})
    plain = json.loads(json.dumps([c.as_dict() for c in contest(search, undecided(search))]))
    again = decided_again([Contestant.from_dict(one) for one in plain], trials, known, SETTINGS)
    assert again.rungs[-1].effects == [right]
    for role in ("train", "validate"):
        assert len(known[role].trials) == len(trials[role].trials) + 1
    assert known["heldout"] is trials["heldout"]
    assert again.rounds[0][0].effects == (right,)
    # judged where the effect was found: what the further trial holds besides does not count
    verdict = judge(again, trials, SETTINGS)
    assert verdict.kind == "named" or right is LoadDependentFriction, "the trials hold the other"
    own = trials["validate"](again.rungs[-1].fit.changes)[trials["validate"].rows]
    assert again.rungs[-1].scores["validate"].rmse == pytest.approx(np.sqrt(np.mean(own**2)))


def test_a_trial_that_nobody_explains_is_set_aside(search, trials, plant):
    """Something else happens there, ten times as large as what is in question."""
    best = proposed(search, undecided(search), trials["validate"], SETTINGS)[0]
    rng, further = np.random.default_rng(1), {}
    for role, plain in zip(("train", "validate"), best.trials, strict=True):
        log = Measurement.from_trace(simulate(plant, Trial.from_plain(plain), TRUE, 0.002))
        slow = np.cumsum(rng.standard_normal((len(log.current), 1)), axis=0) * 0.05
        further[role] = [replace(log, current=log.current + slow)]
    known = joined(trials, further)
    assert decided_again(contest(search, undecided(search)), trials, known, SETTINGS) is None


@pytest.mark.parametrize(("before", "aside"), [("named", True), ("undecided", False)])
def test_a_further_trial_does_not_leave_open_what_was_named(
    search, trials, monkeypatch, before, aside
):
    """Both foretell it about as well: of two that say the same where they were found one stands."""
    monkeypatch.setitem(decided_again.__globals__, "judge", lambda *_: undecided(search))
    models = contest(search, undecided(search))
    known = joined(trials, {role: trials[role].trials[:1] for role in ("train", "validate")})
    again = decided_again(models, trials, known, SETTINGS, before)
    assert (again is None) is aside
