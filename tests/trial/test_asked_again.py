"""An undecided robot is asked what separates its rivals best, and judged with those logs too."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from spirob.diagnosis.proposals import Proposal
from spirob.diagnosis.rungs import Settings
from spirob.emulator.rig import HiddenSettings
from spirob.trial.further import asked_again
from tests.identify.known import residual, spirob

ROBOT = HiddenSettings("rotor_friction:0.1"), 41
ASKED = ("train", "validate")
UNDECIDED = SimpleNamespace(kind="undecided", rivals=["cogging"])


@pytest.fixture(scope="module")
def problems():
    return {role: residual(spirob(), {}, role) for role in ("train", "validate", "heldout")}


@pytest.mark.parametrize(
    ("answer", "told"),
    [("judged again", ("judged again", "hold")), (None, ("search", "hold, set aside"))],
)
def test_the_best_proposal_is_played_on_the_same_robot(problems, monkeypatch, answer, told):
    names, played = asked_again.__globals__, []
    best = Proposal("hold", ({"name": "hold_left"},), 0.01, 0.1)
    logs = [replace(problems["validate"].trials[0], name="hold_left")]

    def recorded(hidden, seed, trials):
        played.append((hidden, seed, trials))
        return {"train": logs, "validate": logs, "heldout": []}

    def decided_again(models, own, known, settings, before):
        assert (models, own, before) == ("contest", problems, UNDECIDED.kind)
        for role in ASKED:
            assert known[role].trials == [*problems[role].trials, *logs]
        return answer

    monkeypatch.setitem(names, "contest", lambda search, verdict: "contest")
    monkeypatch.setitem(names, "proposed", lambda *_: [best, replace(best, name="deep bend")])
    monkeypatch.setitem(names, "recorded", recorded)
    monkeypatch.setitem(names, "decided_again", decided_again)
    assert asked_again("search", UNDECIDED, ROBOT, problems, Settings()) == told
    assert played == [(*ROBOT, best.trials)]


def test_where_nothing_can_be_played_it_stays_undecided(problems, monkeypatch):
    monkeypatch.setitem(asked_again.__globals__, "proposed", lambda *_: [])
    found = asked_again("search", UNDECIDED, ROBOT, problems, Settings())
    assert found == ("search", "")
