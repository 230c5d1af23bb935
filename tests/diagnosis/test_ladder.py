"""When a search goes on: as long as the verdict would find something missing."""

from dataclasses import replace

import numpy as np
import pytest
from spirob.diagnosis.ladder import Rounds
from spirob.diagnosis.rungs import Confirmed, Ladder, Settings

from spirob.diagnosis import ladder as module
from spirob.effects import find_effects
from tests.diagnosis.test_verdict import PROBLEMS, rung

ONE, OTHER = find_effects(["capstan_friction", "current_offset"])


def rounds(settings):
    return Rounds(PROBLEMS, [], [ONE, OTHER], settings, lambda text: None, None)


@pytest.mark.parametrize(("left", "said"), [(0.0029, False), (0.0031, True)])
def test_a_search_goes_on_while_the_verdict_would_miss_something(left, said):
    """The current alone is met here (2 mA of a floor of 3): what the length shows counts too."""
    last = replace(rung([ONE], 0.002, 0.002), errors=np.full(20, left**2))
    search = Ladder(last, [rung([], 0.010, 0.010), last])
    assert rounds(Settings()).goes_on(search) is said


@pytest.mark.parametrize(
    ("error", "always", "said"),
    [(0.0029, False, False), (0.0029, True, True), (0.0031, False, True)],
)
def test_a_search_begins_where_the_error_could_hold_an_effect(error, always, said):
    base = rung([], error, error)
    assert rounds(Settings(always=always)).goes_on(Ladder(base, [base])) is said


def test_of_two_added_together_each_needs_a_share_of_what_they_bring(monkeypatch):
    """Not the size of a first effect, which neither had alone."""
    asked = []
    monkeypatch.setattr(module, "pruned", lambda *given: asked.append(given[-1]))
    monkeypatch.setattr(module, "exchanged", lambda *given: None)
    monkeypatch.setattr(module, "finished", lambda found, *given: found)
    base, grown = rung([], 0.010, 0.010), rung([ONE, OTHER], 0.006, 0.006)
    pair = Confirmed((ONE, OTHER), 0.5, grown.fit, np.zeros(100), grown.errors, grown.scores)
    search = Ladder(base, [base])
    rounds(Settings())._grow(search, [pair], PROBLEMS)
    assert search.rungs[-1].effects == [ONE, OTHER]
    assert asked == [pytest.approx(0.25 * 0.008)]
