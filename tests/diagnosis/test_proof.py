"""A name is put to the proof on a further trial: the right one holds there, its imitation not."""

from dataclasses import replace

import pytest

from spirob.diagnosis.certainty import proven
from spirob.diagnosis.conclusion import Weighed, weigh
from spirob.diagnosis.contest import Contestant, in_question, joined
from spirob.diagnosis.followup import Proof, alone, proved, put_to_proof, sifted, to_prove
from spirob.diagnosis.proposals import told
from spirob.diagnosis.verdict import AGAIN, Verdict, judge
from spirob.effects.tendon.stretch import Stretch
from spirob.effects.winch.backlash import Backlash
from spirob.robot import MOTORS
from tests.diagnosis import machines
from tests.diagnosis.contested import NAMES, SETTINGS, Robot, beside

TRUE = {"backlash.play": 1.5e-3}
NUMBERS = {Stretch: "stretch.toe", Backlash: "backlash.play"}
DRY = {"coulomb_friction": Weighed(0.9, 0.9)}
NAMED = Verdict("named", DRY, "Missing: dry friction.", "It is dry.", "To make sure: crawl.")


@pytest.fixture(scope="module")
def robot():
    return Robot(NUMBERS, TRUE)


@pytest.fixture(scope="module")
def best(robot):
    return to_prove(robot.ended(Backlash))[0]


def test_a_name_is_put_to_a_softer_pull_than_any_it_was_found_under(robot, best):
    assert best.name == "soft pull"
    assert best.share > SETTINGS.floor
    assert best.proves
    line = told([best], robot.trials["validate"].effort)
    assert line.startswith("To make sure: play 'soft pull' (")
    assert all(trial["name"] in line for trial in best.trials)


def test_what_is_asked_of_a_motor_was_seen_of_it(best):
    leads = {"train": set(), "validate": set()}
    for trial in best.trials:
        leads[trial["role"]] |= {m for m, s in trial["motors"].items() if s["mode"] != "current"}
    assert leads == {"train": set(MOTORS), "validate": set(MOTORS)}
    assert len({t["name"] for t in best.trials}) == len(best.trials)


def test_nothing_is_proved_where_nothing_was_found_or_would_show(robot):
    assert to_prove(machines.ended(machines.model([], 0.01))) == []
    assert to_prove(robot.ended(Backlash, replace(SETTINGS, floor=10.0))) == []


@pytest.mark.parametrize("effect", NUMBERS)
def test_the_right_law_holds_and_its_imitation_does_not(effect, robot):
    ended = robot.ended(effect)
    best = to_prove(ended)[0]
    known = joined(robot.trials, robot.played(best))
    models = [Contestant.from_dict(m.as_dict()) for m in in_question(ended, named(effect))]
    (proof,) = put_to_proof(best.name, models, robot.trials, known, SETTINGS).values()
    assert proof.experiment == best.name
    assert proof.share > 0.97 if effect is Backlash else proof.share < 0.8
    assert proof.holds == (effect is Backlash)


def named(effect):
    return replace(NAMED, weighed={effect.name(): Weighed(0.9, 0.9)})


def test_of_two_that_say_the_same_the_one_that_holds_is_named(robot):
    """Found was the imitation; the right law, which stood beside it, takes its place."""
    ended = robot.ended(Stretch)
    models = in_question(ended, beside(ended, "named"))
    assert [m.effects for m in models] == [(), (Stretch,), (Backlash,)]
    best = to_prove(ended)[0]
    known = joined(robot.trials, robot.played(best))
    proofs = put_to_proof(best.name, models, robot.trials, known, SETTINGS)
    assert [proofs[frozenset([e])].holds for e in (Stretch, Backlash)] == [False, True]
    left = sifted(models, proofs, robot.trials, SETTINGS)
    assert set(left.search.models.tried) == {frozenset(), frozenset({"backlash"})}
    verdict = judge(left, weigh(left))
    assert (verdict.kind, verdict.named) == ("named", ["backlash"])
    assert not verdict.contested


def test_what_stays_likely_is_fitted_without_what_does_not(robot):
    bare, whole = (m.fit.changes for m in robot.ended(Backlash).found.rungs)
    numbers = tuple(robot.numbers[e] for e in (Backlash, Stretch))
    both = Contestant((Backlash, Stretch), (*NAMES, *numbers), {**bare, **whole})
    left = alone([Contestant((), tuple(NAMES), bare), both], ["backlash"], robot.trials, SETTINGS)
    assert [e.name() for e in left.found.chosen.effects] == ["backlash"]
    assert set(left.found.chosen.fit.estimates) == {*NAMES, robot.numbers[Backlash]}


@pytest.mark.parametrize("share", [0.2, 0.9])
def test_where_all_hold_or_none_a_proof_does_not_tell_which(share):
    models = [Contestant(effects, (), {}) for effects in ((), (Stretch,), (Backlash,))]
    proofs = {frozenset(m.effects): Proof("hold", share) for m in models[1:]}
    assert sifted(models, proofs, {}, SETTINGS) is None


def test_a_name_that_holds_stands_and_no_further_trial_is_asked_for():
    stands = proved(NAMED, Proof("hold", 1.0))
    assert (stands.kind, stands.next_experiment) == ("named", "")
    assert stands.probability > 0.9


@pytest.mark.parametrize(("sure", "kind"), [(0.99, "named"), (0.6, "unknown")])
def test_the_surer_a_name_was_the_less_a_proof_has_to_show(sure, kind):
    """Right names seldom account for so little, which a sure one outweighs."""
    before = replace(NAMED, weighed={"coulomb_friction": Weighed(sure, sure)})
    after = proved(before, Proof("hold", 0.78))
    assert after.kind == kind
    told = after.weighed["coulomb_friction"]
    assert told.probability == told.together == proven(sure, 0.78) < sure


def test_a_name_that_does_not_hold_is_told_and_taken_away():
    fallen = proved(NAMED, Proof("hold", 0.4))
    assert (fallen.kind, fallen.probability, fallen.next_experiment) == ("unknown", 0.0, AGAIN)
    assert fallen.named == []
    assert "not dry friction." in fallen.sentence
    assert "'hold'" in fallen.explanation
    assert "40%" in fallen.explanation
    assert fallen.weighed["coulomb_friction"].probability == proven(0.9, 0.4)  # stays to be read
    assert not fallen.contested


@pytest.mark.parametrize("share", [0.4, 0.95])
def test_what_is_undecided_stays_so_and_says_what_would_decide(share):
    undecided = replace(
        NAMED, kind="undecided", weighed={"creep": Weighed(0.6, 0.6, [], ["stretch"])}
    )
    assert proved(undecided, Proof("hold", share)) == undecided
