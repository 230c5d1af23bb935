"""A delay that ends at a bound is searched within wider ones while less is left there."""

from dataclasses import dataclass
from types import SimpleNamespace

import pytest

from spirob.machine import axis
from spirob.machine.description.rig import Bounded

PERIOD = 0.01
USUAL = axis.as_usual(PERIOD)
WORTH = SimpleNamespace(
    least=0.01,
    matters=lambda before, after: after.mean_square < 0.9 * before.mean_square,
)


@dataclass(frozen=True)
class Searched:
    """A search about a delay: the best one of its bounds, and what that leaves."""

    delay: Bounded
    true: float
    is_long: bool = False
    untold: bool = True
    said: str = ""

    @property
    def chosen(self):
        best = min(max(self.true, self.delay.low), self.delay.high)
        told = SimpleNamespace(value=best, at_bound=best != self.true)
        return SimpleNamespace(
            mean_square=0.5 + 100 * abs(self.true - best),
            fit=SimpleNamespace(estimates={axis.DELAY: told}),
        )

    @property
    def search(self):
        return SimpleNamespace(worth=WORTH)

    @property
    def ready(self):
        return SimpleNamespace(
            untold=self.untold,
            rig=SimpleNamespace(fit={"delay": self.delay}),
            train=[SimpleNamespace(period=PERIOD)],
            progress=lambda text: None,
        )

    def noted(self, said):
        return Searched(self.delay, self.true, self.is_long, self.untold, said)


@pytest.fixture
def once_more(monkeypatch):
    """Ends a search for whose effects the place is the usual one, from another start."""

    def ended(true, turns=1.0, **about):
        anew = USUAL.model_copy(update={"nominal": 0.5 * USUAL.high})
        monkeypatch.setattr(axis, "_place", lambda search, model: anew)
        monkeypatch.setattr(axis, "turning", lambda recordings: turns)
        monkeypatch.setattr(axis, "_begins_alike", lambda done, delay: False)
        monkeypatch.setattr(axis, "_about", lambda ready, delay: delay)
        monkeypatch.setattr(axis, "_searched", lambda delay: Searched(delay, true))
        monkeypatch.setattr(
            axis,
            "_fits_better",
            lambda done, told, delay: WORTH.matters(done.chosen, Searched(delay, true).chosen),
        )
        return axis._once_more(Searched(USUAL, true, **about))

    return ended


@pytest.mark.parametrize(("true", "high"), [(0.015, 1), (0.03, 2), (-0.07, 4), (0.1, 8)])
def test_bounds_are_widened_until_they_hold_the_delay(true, high, once_more):
    found = once_more(true)
    assert found.delay.high == pytest.approx(high * USUAL.high)
    assert found.chosen.fit.estimates[axis.DELAY].value == true


def test_no_farther_than_the_motion_tells(once_more):
    assert once_more(0.1, turns=0.05).delay.high == pytest.approx(2 * USUAL.high)
    assert once_more(0.1, turns=0.01).delay == USUAL


def test_a_long_search_says_that_it_did_not_look(once_more):
    assert once_more(0.1, is_long=True).said == axis.NOT_ELSEWHERE
    assert once_more(0.1, untold=False).delay == USUAL
