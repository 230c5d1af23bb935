"""What was found is put to the proof on the robot on which it was found; nothing else is."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from spirob.diagnosis.proof import Proof
from spirob.diagnosis.proposals import Proposal
from spirob.diagnosis.rungs import Settings
from spirob.diagnosis.verdict import Verdict
from spirob.emulator.rig import HiddenSettings
from spirob.trial.further import judged as judged_on

ROBOT = HiddenSettings("rotor_friction:0.1"), 41
BEST = Proposal("hold", ({"name": "hold_left"},), 0.01, 0.1)
OTHER = replace(BEST, name="deep bend")
SEARCH, LEFT = (SimpleNamespace(rungs=[SimpleNamespace(effects=[])]) for _ in range(2))
PROBLEMS = {"validate": "the trials that decide"}


@pytest.fixture
def judged(monkeypatch):
    """The verdict on the robot's trials, once it was put to a proof with this outcome."""
    names, played = judged_on.__globals__, []

    def put_to_proof(experiment, models, own, known, settings):
        assert (experiment, models, own, known) == ("hold", "models", PROBLEMS, "joined")
        return {frozenset(): Proof(experiment, judge.share)}

    def recorded(*asked):
        played.append(asked)
        return "logs"

    def judge(kind, share, experiments=(BEST, OTHER), left=None):
        judge.share = share
        verdict = Verdict(kind, 0.8, [], "Missing: friction.", "", "")
        monkeypatch.setitem(names, "judge", lambda *_: verdict)
        monkeypatch.setitem(names, "to_prove", lambda *_: list(experiments))
        monkeypatch.setitem(names, "recorded", recorded)
        monkeypatch.setitem(names, "joined", lambda *_: "joined")
        monkeypatch.setitem(names, "in_question", lambda *_: "models")
        monkeypatch.setitem(names, "sifted", lambda *_: left)
        monkeypatch.setitem(names, "put_to_proof", put_to_proof)
        return (*judged_on(SEARCH, ROBOT, PROBLEMS, Settings()), played)

    return judge


@pytest.mark.parametrize(("share", "kind"), [(0.95, "named"), (0.5, "unknown")])
def test_the_trial_that_would_show_a_name_most_is_played_on_the_same_robot(judged, share, kind):
    search, verdict, proof, played = judged("named", share)
    assert search is SEARCH
    assert (verdict.kind, proof) == (kind, Proof("hold", share))
    assert played == [(*ROBOT, BEST.trials)]


@pytest.mark.parametrize("kind", ["unknown", "nothing_missing"])
def test_where_nothing_is_found_nothing_is_played(judged, kind):
    _, verdict, proof, played = judged(kind, 0.0)
    assert (verdict.kind, proof, played) == (kind, None, [])


def test_who_holds_is_judged_without_the_others(judged):
    search, verdict, _, played = judged("undecided", 0.95, left=LEFT)
    assert search is LEFT
    assert verdict.kind == "undecided"
    assert played


def test_a_name_that_no_trial_would_show_stands(judged):
    _, verdict, proof, played = judged("named", 0.0, experiments=())
    assert (verdict.kind, proof, played) == ("named", None, [])
