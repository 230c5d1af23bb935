"""Where nothing is named, the delay is sought again: beside the law, as usual, and as logged."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import pytest

from spirob.machine import axis
from spirob.machine.description.rig import Bounded

PERIOD = 0.01
USUAL = axis.as_usual(PERIOD)
ELSEWHERE = Bounded(nominal=-0.05, low=-0.06, high=-0.04)
NEARBY = Bounded(nominal=0.05, low=0.04, high=0.06)


@dataclass(frozen=True)
class Verdict:
    kind: str = "unknown"
    doubts: tuple[str, ...] = ()


@dataclass(frozen=True)
class Left:
    """What a model leaves, held out too, and the delay that it was fitted with."""

    square: float
    heldout: float
    fit: object


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
    heldout: float = 1.0

    @property
    def explained(self):
        changes = {axis.DELAY: self.delay.nominal}
        return Left(self.left, self.heldout, SimpleNamespace(changes=changes))

    @property
    def search(self):
        return self.done.search

    @property
    def done(self):
        worth = SimpleNamespace(
            halves=lambda before, after: after.square < 0.5 * before.square,
            matters=lambda before, after: after.square < 0.9 * before.square,
            refuted=lambda one, other: other.heldout < 0.5 * one.heldout,
        )
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
        poor = Judged(USUAL, 1.0)
        found = {USUAL: answers.get("usual", poor), ELSEWHERE: answers.get("elsewhere", poor)}
        found[axis.AS_LOGGED] = answers.get("as_logged", poor)
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


def test_a_log_may_mean_what_it_says(about):
    better = Judged(axis.AS_LOGGED, 0.1, law=LAW)
    assert about(Judged(NEARBY, 1.0), as_logged=better) is better


def test_held_out_logs_decide_where_the_others_do_not_tell(about):
    first, alike = Judged(NEARBY, 1.0), Judged(axis.AS_LOGGED, 1.05, heldout=0.4)
    assert about(first, as_logged=alike) is alike
    assert about(first, as_logged=Judged(axis.AS_LOGGED, 1.2, heldout=0.4)) is first
    assert about(first, as_logged=Judged(axis.AS_LOGGED, 1.05, heldout=0.6)) is first


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


@dataclass(frozen=True)
class Told:
    """A verdict with the names that it finds likely, and whether a law is composed."""

    kind: str
    names: tuple[str, ...] = ()
    rivals: tuple[str, ...] = ()
    law: object = None

    @property
    def verdict(self):
        weighed = {name: SimpleNamespace(together=0.9) for name in self.names}
        return SimpleNamespace(
            kind=self.kind, weighed=weighed, equivalents=[], rivals=list(self.rivals)
        )


@pytest.mark.parametrize(
    ("again", "judged", "more"),
    [
        (Told("named", ("a",)), Told("unknown"), True),
        (Told("named", ("a", "b")), Told("named", ("a",)), True),
        (Told("undecided", ("b",), ("a",)), Told("named", ("a",)), True),
        (Told("named", ("b",)), Told("named", ("a",)), False),
        (Told("nothing_missing"), Told("named", ("a",)), False),
        (Told("unknown", law=LAW), Told("named", ("a",)), False),
        (Told("unknown", law=LAW), Told("unknown"), True),
        (Told("unknown", law=LAW), Told("unknown", law=LAW), False),
    ],
)
def test_more_data_takes_no_name_away(again, judged, more):
    assert axis._says_more(again, judged) == more


@pytest.mark.parametrize(
    ("left", "plain_left", "kind", "taken"),
    [
        (0.5, 0.1, "unknown", "plain"),
        (0.5, 0.1, "nothing_missing", "plain"),
        (0.5, 0.4, "unknown", "with numbers"),  # no half of it
        (0.5, 0.1, "named", "with numbers"),
        (0.01, 0.001, "unknown", "with numbers"),  # nothing that counts is left
    ],
)
def test_much_left_beside_numbers_of_single_logs_is_asked_again_without(
    left, plain_left, kind, taken, monkeypatch
):
    worth = SimpleNamespace(least=0.1, halves=lambda before, after: after < 0.5 * before)
    worth.matters = lambda before, after: after < before
    worth.refuted = lambda one, other: False

    class Square(float):
        @property
        def mean_square(self):
            return float(self)

    def judged(name, left, plain=None):
        return SimpleNamespace(
            name=name,
            done=SimpleNamespace(plain=plain),
            search=SimpleNamespace(worth=worth),
            verdict=Verdict(kind),
            explained=Square(left),
        )

    alone = judged("plain", plain_left)
    monkeypatch.setattr(axis, "judged_of", lambda searched: alone)
    found = axis._without_numbers_of_logs(judged("with numbers", left, "the search without"))
    assert found.name == taken
    assert axis._without_numbers_of_logs(judged("alone", left)).name == "alone"
