"""One protocol: what is asked is played, decides, and puts a name to the proof.

The pipeline, with a file between the steps, and the trial, in one go, are told the same.
"""

import json
from dataclasses import asdict, replace
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml

import pipeline.ask
import pipeline.decide
import pipeline.diagnose
from pipeline.config import composed
from pipeline.schema import validated
from spirob.campaign.arm import case as trial
from spirob.diagnosis import followup
from spirob.diagnosis.conclusion import Weighed
from spirob.diagnosis.contest import Contestant
from spirob.diagnosis.criteria import Settings
from spirob.diagnosis.followup import Answer, Proof, Question, answered, asked
from spirob.diagnosis.proposals import Proposal
from spirob.diagnosis.verdict import Verdict, judge
from spirob.effects import find_effects
from spirob.effects.tendon.stretch import Stretch
from spirob.effects.winch.backlash import Backlash
from tests.diagnosis.contested import Robot, beside

ROOT = Path(__file__).parents[2]
BEST = Proposal("hold", ({"name": "hold_left"},), 0.01, 0.1)
OTHER = replace(BEST, name="deep bend")
WEIGHED = {"coulomb_friction": Weighed(0.8, 0.8)}
VERDICT = Verdict("named", WEIGHED, "Missing: friction.", "It rubs.", "")
BASE = Contestant((), ("winch.efficiency",), {})
FRICTION = replace(BASE, effects=tuple(find_effects(["coulomb_friction"])))
NAME = frozenset(FRICTION.effects)
SETTINGS = Settings()


def question(kind="named", decide=(), prove=()):
    return Question(replace(VERDICT, kind=kind), (BASE, FRICTION), decide, prove)


@pytest.fixture
def protocol(monkeypatch):
    """The answer to a question where judging and fitting end like this, and what was played."""

    def answer(asked, share=0.9, again=None, held=None, kind="named", logs=True, proofs=None):
        played = []

        def play(one):
            played.append(one)
            return {"train": [one.name]} if logs else {}

        judged = {
            "joined": lambda own, further: (own, further["train"]),
            "decided_again": lambda models, own, known, settings, before: again,
            "put_to_proof": lambda name, *about: proofs or {NAME: Proof(name, share)},
            "sifted": lambda models, proofs, own, settings: held,
            "weigh": lambda ended: WEIGHED,
            "judge": lambda ended, weighed: replace(VERDICT, kind=kind),
            "in_question": lambda ended, verdict: [BASE, FRICTION],
        }
        for name, found in judged.items():
            monkeypatch.setattr(followup, name, found)
        return answered(asked, "own", play, SETTINGS), played

    return answer


def test_the_best_experiment_decides(protocol):
    ended = SimpleNamespace()
    answer, played = protocol(question("undecided", decide=(BEST, OTHER)), again=ended)
    assert played == [BEST]
    assert (answer.ended, answer.verdict.kind, answer.experiment) == (ended, "named", "hold")
    assert not answer.aside


def test_what_tells_nothing_is_set_aside(protocol):
    asked = question("undecided", decide=(BEST,))
    answer, _ = protocol(asked, again=None)
    assert (answer.ended, answer.verdict, answer.aside) == (None, asked.verdict, True)


@pytest.mark.parametrize(("share", "kind"), [(0.95, "named"), (0.5, "unknown")])
def test_the_trial_that_would_show_a_name_most_is_played(protocol, share, kind):
    answer, played = protocol(question(prove=(BEST, OTHER)), share)
    assert played == [BEST]
    assert (answer.verdict.kind, answer.proof) == (kind, Proof("hold", share))
    assert answer.ended is None


def test_who_is_decided_upon_is_put_to_the_proof(protocol):
    answer, played = protocol(
        question("undecided", decide=(BEST,), prove=(OTHER,)), 0.5, again=SimpleNamespace()
    )
    assert played == [BEST, OTHER]
    assert (answer.verdict.kind, answer.proof) == ("unknown", Proof("deep bend", 0.5))


def test_who_holds_is_judged_without_the_others(protocol):
    held = SimpleNamespace()
    answer, _ = protocol(question("undecided", prove=(BEST,)), held=held, kind="undecided")
    assert (answer.ended, answer.verdict.kind) == (held, "undecided")


@pytest.mark.parametrize(("share", "names"), [(0.95, ["coulomb_friction"]), (0.5, [])])
def test_a_lesser_name_that_falls_in_its_proof_takes_no_other_with_it(
    protocol, monkeypatch, share, names
):
    """Alone, what stays likely is put to the same proof."""
    asked, seen = question(prove=(BEST,)), []
    sure = {"coulomb_friction": Weighed(0.99, 0.99), "creep": Weighed(0.6, 0.6)}
    two = replace(VERDICT, weighed=sure)
    both = replace(BASE, effects=tuple(find_effects(["coulomb_friction", "creep"])))
    shares = {frozenset(both.effects): 0.78, NAME: share}

    def alone(models, kept, own, settings):
        seen.append(kept)
        return SimpleNamespace()

    monkeypatch.setattr(followup, "alone", alone)
    proofs = {effects: Proof("hold", found) for effects, found in shares.items()}
    answer, played = protocol(replace(asked, verdict=two, models=(BASE, both)), proofs=proofs)
    assert (seen, played) == ([["coulomb_friction"]], [BEST])
    assert (answer.verdict.named, answer.proof) == (names, proofs[NAME])


@pytest.mark.parametrize("kind", ["unknown", "nothing_missing"])
def test_where_nothing_is_left_of_a_name_nothing_is_proved(protocol, kind):
    asked = question("undecided", decide=(BEST,), prove=(OTHER,))
    answer, played = protocol(asked, again=SimpleNamespace(), kind=kind)
    assert (played, answer.proof, answer.verdict.kind) == ([BEST], None, kind)


def test_what_cannot_be_played_leaves_the_verdict(protocol):
    asked = question("undecided", decide=(BEST,), prove=(OTHER,))
    answer, played = protocol(asked, logs=False)
    assert played == [BEST, OTHER]
    assert answer == Answer(asked.verdict, models=asked.models)


def test_the_pipeline_and_the_trial_give_one_robot_the_same_answer():
    """Through files as in one go; and both take the play for what it is."""
    robot = Robot({Stretch: "stretch.toe", Backlash: "backlash.play"}, {"backlash.play": 1.5e-3})
    ended = robot.ended(Stretch)
    at_once = asked(ended, beside(ended))
    filed = Question.from_dict(json.loads(json.dumps(at_once.as_dict())))
    assert filed == at_once
    assert [one.name for one in filed.wanted] == [at_once.decide[0].name, "soft pull"]
    one, other = (answered(each, robot.trials, robot.played, SETTINGS) for each in (at_once, filed))
    assert asdict(one.verdict) == asdict(other.verdict)
    assert (one.experiment, one.aside, one.proof) == (other.experiment, other.aside, other.proof)
    chosen = [each.ended.found.chosen for each in (one, other)]
    assert [m.effects for m in chosen] == [(Backlash,), (Backlash,)]
    assert chosen[0].fit.changes == chosen[1].fit.changes


def test_a_question_of_a_verdict_that_is_doubted_comes_back_as_it_was():
    doubted = Question(Verdict("unknown", WEIGHED, "None.", "Why.", "", ("A sign is turned.",)))
    assert Question.from_dict(json.loads(json.dumps(doubted.as_dict()))) == doubted
    assert doubted.wanted == []


def test_what_the_pipeline_runs_is_what_the_trial_scores():
    """The same search, verdict, question and answer, by the same rules."""
    stages = (pipeline.diagnose, pipeline.ask, pipeline.decide)
    for name in ("Simulated", "begun", "searched", "asked", "answered"):
        own = [getattr(stage, name) for stage in stages if hasattr(stage, name)]
        assert own == [getattr(trial, name)], name
    assert followup.judge is judge
    config = validated(composed(ROOT, []), "conf")
    assert pipeline.diagnose.settings_of(config) == Settings()
    told = yaml.safe_load((ROOT / "conf/diagnose/default.yaml").read_text())
    assert told == config.public()["diagnose"], "every rule stands there, with its default"


def test_the_trial_of_the_pipeline_follows_its_rules(tmp_path, monkeypatch):
    import pipeline.trial as stage

    rules = ["diagnose.veto=0.3", "identify.scale=0.07"]
    config = validated(composed(ROOT, rules), "conf")
    given = {}
    monkeypatch.setattr(stage, "public_config", lambda root: config)
    monkeypatch.setattr(stage, "play", lambda *called: given.update(settings=called[3]) or [])
    stage.stage(tmp_path)
    assert given["settings"] == Settings(veto=0.3, scale=0.07, intervals=False, always=False)
