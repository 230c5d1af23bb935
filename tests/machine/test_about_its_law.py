"""Where nothing is named, the delay is sought once more, beside the law that was composed."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import pytest

from spirob.machine import axis
from spirob.machine.rig import Bounded

PERIOD = 0.01
USUAL = axis.as_usual(PERIOD)
ELSEWHERE = Bounded(nominal=-0.05, low=-0.06, high=-0.04)
NEARBY = Bounded(nominal=0.05, low=0.04, high=0.06)


@dataclass(frozen=True)
class Verdict:
    kind: str = "unknown"
    doubts: tuple[str, ...] = ()


@dataclass(frozen=True)
class Judged:
    """A verdict about a delay, and what is left of it; the law leaves as much."""

    delay: Bounded
    left: float
    verdict: Verdict = field(default_factory=Verdict)
    law: object = None
    untold: bool = True
    is_long: bool = False
    said: str = ""

    @property
    def explained(self):
        return self.left

    @property
    def done(self):
        worth = SimpleNamespace(halves=lambda before, after: after < 0.5 * before)
        rig = SimpleNamespace(fit={"delay": self.delay})
        train = [SimpleNamespace(period=PERIOD)]
        ready = SimpleNamespace(untold=self.untold, rig=rig, train=train)
        return SimpleNamespace(
            ready=ready, search=SimpleNamespace(worth=worth), is_long=self.is_long
        )

    def noted(self, said):
        return SimpleNamespace(said=said, delay=self.delay)


LAW = SimpleNamespace(model=None)


@pytest.fixture
def about(monkeypatch):
    """Judges about the delays that are looked at; the law of any says ELSEWHERE."""

    def judged(first, **answers):
        found = {USUAL: answers.get("usual"), ELSEWHERE: answers.get("elsewhere")}
        monkeypatch.setattr(axis, "_place_beside", lambda search, model: ELSEWHERE)
        monkeypatch.setattr(axis, "_about", lambda ready, delay: delay)
        monkeypatch.setattr(axis, "_searched", lambda delay: delay)
        monkeypatch.setattr(axis, "judged_of", lambda delay: found[delay])
        return axis._about_its_law(first)

    return judged


def test_the_law_says_where_the_delay_is(about):
    better = Judged(ELSEWHERE, 0.1, law=LAW)
    assert about(Judged(USUAL, 1.0, law=LAW), elsewhere=better) is better


def test_what_does_not_halve_the_rest_is_no_reason(about):
    first = Judged(USUAL, 1.0, law=LAW)
    assert about(first, elsewhere=Judged(ELSEWHERE, 0.6, law=LAW)) is first
    doubted = Judged(ELSEWHERE, 0.1, Verdict(doubts=("another machine",)))
    assert about(first, elsewhere=doubted) is first


def test_without_a_law_the_usual_delay_is_looked_at(about):
    better = Judged(USUAL, 0.1, Verdict("named"))
    assert about(Judged(NEARBY, 1.0), usual=better) is better


@pytest.mark.parametrize(
    "first",
    [
        Judged(NEARBY, 1.0, Verdict("named"), LAW),
        Judged(NEARBY, 1.0, Verdict(doubts=("another machine",)), LAW),
        Judged(NEARBY, 1.0, law=LAW, untold=False),
        Judged(USUAL, 1.0),
        Judged(ELSEWHERE, 1.0, law=LAW, untold=False),
    ],
)
def test_nothing_is_searched_again_without_a_reason(first, about):
    assert about(first) is first


def test_a_search_that_took_long_says_what_it_left_out(about):
    assert "delay" in about(Judged(NEARBY, 1.0, law=LAW, is_long=True)).said
