"""A name is put to the proof on a further trial: the right one holds there, its imitation not."""

from dataclasses import replace

import pytest
from spirob.diagnosis.rungs import ROLES, Ladder, Rung, Settings, rung_of, scores_of

from spirob.diagnosis.contest import Contestant, in_question, joined
from spirob.diagnosis.followup import Proof, proved, put_to_proof, sifted, to_prove
from spirob.diagnosis.proposals import told
from spirob.diagnosis.verdict import AGAIN, Verdict, judge
from spirob.effects.tendon.stretch import Stretch
from spirob.effects.winch.backlash import Backlash
from spirob.identify.fit import fit
from spirob.identify.measurement import Measurement
from spirob.robot import MOTORS
from spirob.trials import Trial
from spirob.trials.simulation import simulate
from tests.identify.known import residual, spirob

TRUE = {"backlash.play": 1.5e-3}
NUMBERS = {Backlash: "backlash.play", Stretch: "stretch.toe"}
SETTINGS = Settings()
NAMED = Verdict(
    "named",
    0.9,
    [],
    "Missing: dry friction.",
    "It is dry.",
    "To make sure: crawl.",
    evidence={"coulomb_friction": {"probability": 0.9, "figures": {}}},
)


@pytest.fixture(scope="module")
def plant():
    return spirob([Backlash, Stretch])


@pytest.fixture(scope="module")
def trials(plant):
    return {role: residual(plant, TRUE, role, seed=3) for role in ROLES}


@pytest.fixture(scope="module")
def base(trials):
    names = ["winch.efficiency"]
    return rung_of("fitted parameters", [], fit(trials["train"], names, {}, 0.05), trials)


@pytest.fixture(scope="module")
def named(trials, base):
    """As if a search had ended with this name."""

    def search(effect):
        found = fit(trials["train"], ["winch.efficiency", NUMBERS[effect]], {}, 0.05)
        scores, _, errors = scores_of(found, trials)
        return Ladder(base, [base, Rung("+ one", [effect], found, scores, errors)])

    return search


def played(plant, experiment):
    """The further trials on the machine as it is, with noise of the sensor."""
    found = {"train": [], "validate": []}
    for k, trial in enumerate(experiment.trials):
        trace = simulate(plant, Trial.from_plain(trial), TRUE, 0.002, seed=k)
        found[trial["role"]].append(Measurement.from_trace(trace))
    return found


def test_a_name_is_put_to_a_softer_pull_than_any_it_was_found_under(named, trials):
    (best,) = to_prove(named(Backlash), trials["validate"], SETTINGS)
    assert best.name == "soft pull"
    assert best.share > SETTINGS.floor
    line = told([best], trials["validate"].effort)
    assert line.startswith("To make sure: play 'soft pull' (")
    assert all(trial["name"] in line for trial in best.trials)


def test_what_is_asked_of_a_motor_was_seen_of_it(named, trials):
    (best,) = to_prove(named(Backlash), trials["validate"], SETTINGS)
    leads = {"train": set(), "validate": set()}
    for trial in best.trials:
        leads[trial["role"]] |= {m for m, s in trial["motors"].items() if s["mode"] != "current"}
    assert leads == {"train": set(MOTORS), "validate": set(MOTORS)}
    assert len({t["name"] for t in best.trials}) == len(best.trials)


def test_nothing_is_proved_where_nothing_was_found_or_would_show(base, named, trials):
    assert to_prove(Ladder(base, [base]), trials["validate"], SETTINGS) == []
    loose = replace(SETTINGS, floor=10.0)
    assert to_prove(named(Backlash), trials["validate"], loose) == []


@pytest.mark.parametrize("effect", NUMBERS)
def test_the_right_law_holds_and_its_imitation_does_not(effect, named, trials, plant):
    search = named(effect)
    best = to_prove(search, trials["validate"], SETTINGS)[0]
    known = joined(trials, played(plant, best))
    models = [Contestant.from_dict(m.as_dict()) for m in in_question(search, NAMED)]
    proof = put_to_proof(best.name, models, trials, known, SETTINGS)[frozenset([effect])]
    assert proof.experiment == best.name
    if effect is Backlash:
        assert proof.share > 0.97
    else:
        assert proof.share < 0.8
    assert proof.holds == (effect is Backlash)


def test_of_two_that_say_the_same_the_one_that_holds_is_named(named, trials, plant):
    """Found was the imitation; the right law, which stood beside it, takes its place."""
    base, found, right = (
        Contestant(tuple(r.effects), tuple(r.fit.estimates), r.fit.changes)
        for r in (*named(Stretch).rungs, named(Backlash).rungs[-1])
    )
    models = [base, found, right]
    best = to_prove(named(Stretch), trials["validate"], SETTINGS)[0]
    known = joined(trials, played(plant, best))
    proofs = put_to_proof(best.name, models, trials, known, SETTINGS)
    assert [proofs[frozenset([e])].holds for e in (Stretch, Backlash)] == [False, True]
    left = sifted(models, proofs, trials, SETTINGS)
    assert [c.effects for c in left.rounds[0]] == [(Backlash,)]
    verdict = judge(left, trials, SETTINGS)
    assert (verdict.kind, left.rungs[-1].effects) == ("named", [Backlash])
    assert not verdict.contested


@pytest.mark.parametrize("share", [0.2, 0.9])
def test_where_all_hold_or_none_a_proof_does_not_tell_which(share, trials):
    models = [Contestant(effects, (), {}) for effects in ((), (Stretch,), (Backlash,))]
    proofs = {frozenset(m.effects): Proof("hold", share) for m in models[1:]}
    assert sifted(models, proofs, trials, SETTINGS) is None


def test_a_name_that_holds_stands_and_no_further_trial_is_asked_for():
    stands = proved(NAMED, Proof("hold", 0.95))
    assert stands == replace(NAMED, next_experiment="")


def test_a_name_that_does_not_hold_is_told_and_taken_away():
    fallen = proved(NAMED, Proof("hold", 0.4))
    assert (fallen.kind, fallen.probability, fallen.next_experiment) == ("unknown", 0.0, AGAIN)
    assert "not dry friction." in fallen.sentence
    assert "'hold'" in fallen.explanation
    assert "40%" in fallen.explanation
    assert fallen.evidence == NAMED.evidence  # why it was named stays to be read
    assert not fallen.contested


@pytest.mark.parametrize("share", [0.4, 0.95])
def test_what_is_undecided_stays_so_and_says_what_would_decide(share):
    undecided = replace(NAMED, kind="undecided", rivals=["stretch"])
    assert proved(undecided, Proof("hold", share)) == undecided
