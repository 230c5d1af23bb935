"""A name is given where such names were right; trials that had no part in it say most."""

import json
from dataclasses import asdict, replace

import numpy as np
import pytest

from spirob.diagnosis import conclusion as module
from spirob.diagnosis.certainty import LIKELY, probability
from spirob.diagnosis.conclusion import Weighed, concluded, likely, weigh
from spirob.diagnosis.criteria import Criteria
from spirob.diagnosis.document import candidates, findings
from spirob.diagnosis.model import Offer
from spirob.diagnosis.verdict import AGAIN, SENSELESS, Verdict, judge, searched
from spirob.effects import find_effects
from tests.diagnosis.machines import SAMPLES, Linear, ended, fit_of, model

EFFECT, KIN, OTHER, FAR = find_effects(
    ["coulomb_friction", "presliding_friction", "cogging", "load_dependent_friction"]
)
NAME = EFFECT.name()
BARE = model([], 0.010)


def found(heldout=0.002, decided=0.002, **told):
    """One effect, 10 mA to 2 where that decides; on the held-out trials to `heldout`."""
    return ended(BARE, model([EFFECT], decided, heldout), **told)


def sure(*given, **told):
    return weigh(found(*given, **told))[NAME].probability


def judged(one):
    return judge(one, weigh(one))


def test_a_name_that_holds_on_held_out_trials_is_named():
    verdict = judged(found())
    assert (verdict.kind, verdict.named) == ("named", [NAME])
    assert verdict.sentence == f"Missing: {EFFECT.title}."
    assert verdict.probability == sure() >= LIKELY
    assert "falls from 10 to 2 mA, from 1.0% to 0.2% of the motor current's" in verdict.explanation


@pytest.mark.parametrize("heldout", [0.010, 0.02])
def test_a_name_that_does_not_is_unknown(heldout):
    verdict = judged(found(heldout))
    assert (verdict.kind, verdict.probability, verdict.named) == ("unknown", 0.0, [])
    assert verdict.sentence.endswith("likely enough.")  # what is denied is not near
    assert f"coulomb friction ({sure(heldout):.0%})" in verdict.explanation  # how unlikely, is said
    assert verdict.next_experiment == AGAIN
    assert ("rises from 10 to 20 mA, from 1.0% to 2.0%" in verdict.explanation) is (heldout > 0.01)


@pytest.mark.parametrize(("near", "said"), [(0.3, " with 30%."), (0.004, "likely enough.")])
def test_what_is_near_is_told_with_how_near_it_is(near, said):
    verdict = judge(found(), {NAME: Weighed(near, near)})
    assert verdict.kind == "unknown"
    assert verdict.sentence.endswith(said)


def test_of_effects_that_hide_each_other_the_one_that_is_needed_stays():
    """Both are vague, the needed one more so; alone each would be likely."""
    both = model([OTHER, EFFECT], 0.01)
    half = {OTHER: 3.0, EFFECT: 4.0}  # of an interval, of numbers of size 1
    told = {}
    for effect, width in half.items():
        told |= fit_of([effect], both.left, width).estimates
    both = replace(both, fit=replace(both.fit, estimates=told))
    one = ended(model([], 0.1), model([OTHER], 0.06), model([EFFECT], 0.02), both)
    assert not likely(weigh(one))
    stands, weighed = concluded(one.search, one.found)
    assert stands.found.chosen.names == {NAME}
    assert likely(weighed) == [NAME]


@pytest.mark.parametrize(("veto", "said"), [(0.3, True), (0.6, False)])
def test_what_held_out_trials_do_not_confirm_by_the_veto_is_not_likely_at_all(veto, said):
    """It takes half of their square."""
    one = found(np.sqrt(0.5) * 0.010, criteria=Criteria(veto=veto))
    (told,) = weigh(one).values()
    assert (told.probability > 0.0) is said
    assert not told.probability or told.probability == probability(told.figures, EFFECT.name())


def test_the_more_a_name_leaves_the_less_likely_it_is():
    told = [sure(heldout) for heldout in (0.002, 0.004, 0.006, 0.008, 0.010)]
    assert told == sorted(told, reverse=True)
    assert told[0] > LIKELY > told[-1]
    assert sure(0.004, share=0.9) < sure(0.004, share=0.0)


def test_another_that_does_as_well_on_held_out_trials_makes_it_less_likely():
    rival = model([OTHER], 0.0035, 0.0035, np.full(SAMPLES, 0.01))
    with_it = weigh(ended(BARE, rival, model([EFFECT], 0.002)))[NAME].probability
    assert with_it < sure()


@pytest.mark.parametrize(
    ("alone", "whole", "rivals", "kind"),
    [
        (0.3, 0.8, [KIN.name()], "undecided"),
        (0.3, 0.4, [], "unknown"),
        (0.7, 0.9, [], "named"),
        (0.0, 0.9, [], "unknown"),
    ],
)
def test_a_name_that_is_unlikely_alone_may_be_likely_with_its_kin(
    monkeypatch, alone, whole, rivals, kind
):
    """It is then one of several, between which nothing is decided; one that is denied is none."""
    told = {"fall_heldout": 1.0 if alone else -1.0}
    monkeypatch.setattr(module, "figures", lambda *given: told)
    monkeypatch.setattr(module, "probability", lambda f, name, of: whole if of == "kin" else alone)
    one = ended(BARE, model([KIN], 0.003), model([EFFECT], 0.002))
    verdict = judged(one)
    assert verdict.weighed[NAME].probability == alone
    assert verdict.weighed[NAME].rivals == rivals
    assert verdict.kind == kind
    assert bool(likely(verdict.weighed)) is (kind != "unknown")


def test_no_name_is_said_both_to_be_the_same_and_to_be_another(monkeypatch):
    monkeypatch.setattr(module, "figures", lambda *given: {"fall_heldout": 1.0})
    monkeypatch.setattr(module, "probability", lambda f, name, of: 0.8 if of == "kin" else 0.3)
    one = ended(BARE, model([KIN], 0.003), model([EFFECT], 0.002))
    one.found.equivalents[NAME] = [KIN.name(), FAR.name()]
    told = weigh(one)[NAME]
    assert (told.rivals, told.equivalents) == ([KIN.name()], [FAR.name()])


def test_beside_a_sure_name_another_may_be_one_of_its_kin(monkeypatch):
    """Both are then needed: the first is named, and between those of the second is decided."""
    shares = {EFFECT.name(): 0.9, OTHER.name(): 0.3}
    monkeypatch.setattr(module, "figures", lambda one, e: {"fall_heldout": 1.0, "of": e.name()})
    monkeypatch.setattr(
        module, "probability", lambda f, name, of: 0.8 if of == "kin" else shares[f["of"]]
    )
    first, last = model([EFFECT], 0.004), model([EFFECT, OTHER], 0.002)
    verdict = judged(ended(BARE, first, model([EFFECT, FAR], 0.0025), last))
    assert verdict.kind == "undecided"
    told = f"Missing: {EFFECT.title}. Undecided beside it: cogging or load dependent friction."
    assert verdict.sentence == told
    assert verdict.explanation.startswith(EFFECT.signature)
    assert {n: one.rivals for n, one in verdict.weighed.items()} == {
        EFFECT.name(): [],
        OTHER.name(): [FAR.name()],
    }
    assert likely(verdict.weighed) == [EFFECT.name(), OTHER.name()]


@pytest.mark.parametrize(("effect", "said"), [(EFFECT, False), (OTHER, True)])
def test_what_something_else_denies_is_withheld_and_nothing_else_is(effect, said):
    one = ended(BARE, model([effect], 0.002))
    assert bool(likely(weigh(one, lambda chosen: {EFFECT.name()}))) is said
    assert bool(likely(weigh(one)))


def both(second, **told):
    """A second effect that takes 4 mA to 2 where that decides, and to `second` held out."""
    first = model([EFFECT], 0.004, 0.004)
    return ended(BARE, first, model([OTHER], 0.009), model([EFFECT, OTHER], 0.002, second), **told)


@pytest.mark.parametrize(("second", "names"), [(0.0039, [NAME]), (0.0015, [NAME, OTHER.name()])])
def test_what_is_unlikely_beside_what_is_likely_goes_and_is_said(second, names):
    one = both(second)
    last, weighed = concluded(one.search, one.found)
    verdict = judge(last, weighed)
    assert (verdict.kind, verdict.named) == ("named", names)
    assert [e.name() for e in last.found.chosen.effects] == names
    assert list(verdict.weighed) == [NAME, OTHER.name()]
    unlikely = f"cogging ({verdict.weighed[OTHER.name()].probability:.0%})"
    assert (unlikely in verdict.explanation) is (len(names) == 1)
    assert verdict.probability == min(verdict.weighed[n].probability for n in names)


@pytest.mark.parametrize(("half", "names"), [(4.0, [NAME]), (0.9, [NAME, OTHER.name()])])
def test_of_effects_that_hide_each_other_one_is_named(half, names):
    """Half intervals of 4 for amplitudes of 1 tell none of two; alone the first is known to 5 %.

    What is known to 90 % though it is as unlikely stays.
    """
    last = model([OTHER, EFFECT], 0.0016, 0.0018, half=half)
    first = model([EFFECT], 0.0017, 0.0018)
    one = ended(BARE, first, model([OTHER], 0.0090, 0.0090), last, least=0.0001)
    assert not likely(weigh(one))
    weighed = concluded(one.search, one.found)[1]
    assert set(weighed) == set(names)
    assert likely(weighed) == (names if len(names) == 1 else [])


def test_a_sentence_names_what_the_verdict_names_and_no_more():
    one = both(0.0039)
    verdict = judge(*concluded(one.search, one.found))
    assert verdict.named == [NAME]
    assert OTHER.title not in verdict.sentence


@pytest.mark.parametrize(("share", "names"), [(1.0, [NAME]), (0.1, [NAME, OTHER.name()])])
def test_what_stands_for_more_than_it_took_is_not_even_weighed(share, names):
    """More is left above noise than the second effect explains."""
    last = model([EFFECT, OTHER], 0.0035, 0.0015)
    first = model([EFFECT], 0.004, 0.004)
    one = ended(BARE, first, model([OTHER], 0.009), last, share=share, least=0.001)
    assert list(concluded(one.search, one.found)[1]) == names


def test_what_is_left_beside_a_name_is_said():
    assert judged(found()).explanation.endswith("RMS.")
    assert judged(found(said="More is left.")).explanation.endswith("RMS. More is left.")


@pytest.mark.parametrize(
    ("missing", "chosen", "kind"),
    [
        (False, 0.0019, "nothing_missing"),
        (True, 0.0019, "unknown"),
        (False, 0.0001, "unknown"),  # an effect takes twice the least size, though no name does
    ],
)
def test_without_a_name_what_counts_is_missing_or_nothing_is(missing, chosen, kind):
    bare = model([], 0.002, 0.002)
    one = ended(bare, model([EFFECT], chosen, 0.003), missing=missing, least=0.0009)
    verdict = judged(one)
    assert verdict.kind == kind
    assert verdict.probability == (1.0 if kind == "nothing_missing" else 0.0)
    if kind == "nothing_missing":
        said = "Nothing is missing that these data show: 0.2% of the motor current is left."
        assert verdict.sentence == said
        assert verdict.explanation.startswith("Nothing is left.")


def test_nothing_missing_tells_the_held_out_share_where_it_is_twice_the_other():
    verdict = judged(ended(model([], 0.002, 0.005), least=0.002, missing=False))
    assert verdict.sentence.endswith("0.2% of the motor current is left, 0.5% of that held out.")


def test_where_nothing_was_found_what_is_left_says_what_it_is():
    verdict = judged(ended(BARE))
    assert (verdict.kind, verdict.sentence) == ("unknown", "It is not known.")
    assert verdict.explanation == "Nothing says what it is."


def test_what_was_vetoed_is_said():
    verdict = judged(found(vetoed=[OTHER.name()]))
    assert verdict.kind == "named"
    assert "it lowers the error on the training trials: cogging." in verdict.explanation


def test_a_veto_that_another_model_belies_is_not():
    """With the vetoed effect a model leaves less of the held-out trials than what was chosen."""
    better = model([OTHER], 0.004, 0.001)
    one = ended(BARE, better, model([EFFECT], 0.002, 0.002), vetoed=[OTHER.name()])
    assert "lowers the error on the training" not in judged(one).explanation


DOUBTS = ("The sign is turned.", "A log is of another machine.")


def test_whoever_doubts_gives_no_name_and_says_why():
    one = found()
    verdict = judge(one, weigh(one), DOUBTS)
    assert (verdict.kind, verdict.sentence, verdict.doubts) == ("unknown", SENSELESS, DOUBTS)
    assert (verdict.named, verdict.probability) == ([], 0.0)
    assert verdict.explanation == " ".join(DOUBTS)
    assert verdict.weighed[NAME].probability >= LIKELY, "what the errors say stays to be read"
    unlikely = found(0.02)
    assert judge(unlikely, weigh(unlikely), DOUBTS).explanation == " ".join(DOUBTS)
    assert findings(verdict, one.found.chosen)["effects"] == []
    assert json.loads(json.dumps(asdict(verdict)))["doubts"] == list(DOUBTS)


@pytest.mark.parametrize(
    ("rival", "said"),
    [
        (KIN, "dry friction by one of its laws (coulomb friction or presliding friction)."),
        (FAR, "Undecided: coulomb friction or load dependent friction."),
    ],
)
def test_where_only_laws_of_dry_friction_are_in_question_dry_friction_is_said(rival, said):
    one = found(rivals={NAME: [rival.name()]})
    one.search.candidates = [EFFECT, KIN, FAR]
    verdict = judged(one)
    assert (verdict.kind, verdict.rivals) == ("undecided", [rival.name()])
    assert said in verdict.sentence
    assert verdict.named == []
    assert verdict.contested
    assert verdict.next_experiment.startswith("To decide: ")


def test_who_says_the_same_is_told_beside_the_name():
    verdict = judged(found(equivalents={NAME: [FAR.name()]}))
    assert (verdict.kind, verdict.equivalents) == ("named", [FAR.name()])
    assert "(on this rig the same as load dependent friction)" in verdict.sentence
    assert verdict.contested
    assert not judged(found()).contested


@pytest.mark.parametrize(
    ("one", "chance"),
    [
        (Weighed(0.8, 0.8, [], [KIN.name(), FAR.name()]), 0.1),  # each half of what is left of 1
        (Weighed(0.3, 0.7, [], [KIN.name(), FAR.name()]), 0.2),  # of what they are together
        (Weighed(0.2, 0.2, [], [KIN.name(), FAR.name()]), 0.0),  # none of what is not there
    ],
)
def test_rivals_share_what_is_left_of_the_probability(one, chance):
    known = found()
    known.found.offers = [Offer(e, {}, 0.5 * BARE.mean_square) for e in (EFFECT, KIN, FAR, OTHER)]
    entries = candidates(known.search, known.found, Verdict("undecided", {NAME: one}, "", "", ""))
    told = {entry["name"]: entry["probability"] for entry in entries}
    assert told[NAME] == one.probability
    assert told[KIN.name()] == told[FAR.name()] == pytest.approx(chance)
    assert told[OTHER.name()] == 0.0


def test_pipeline_trial_and_arm_are_judged_in_one_go():
    """With what must be doubted, and with every step told."""
    rng = np.random.default_rng(2)
    one, two = rng.standard_normal((2, 2 * SAMPLES))
    told: list[str] = []
    machine = Linear(0.1 * one, {EFFECT: one, OTHER: two})
    last, verdict = searched(machine, [EFFECT, OTHER], Criteria(), told.append)
    assert (verdict.kind, verdict.named) == ("named", [NAME])
    assert last.found.chosen.effects == (EFFECT,)
    assert any("chosen so far: coulomb_friction" in line for line in told)
    again = Linear(0.1 * one, {EFFECT: one, OTHER: two})
    assert searched(again, [EFFECT, OTHER], Criteria(), doubts=DOUBTS)[1].doubts == DOUBTS
