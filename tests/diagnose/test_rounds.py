"""When a search goes on: as long as the verdict would find something missing."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.diagnose.rounds import Rounds
from spirob.diagnose.rungs import Search, Settings
from spirob.effects import find_effects
from tests.diagnose.test_verdict import PROBLEMS, rung

ONE, OTHER = find_effects(["capstan_friction", "current_offset"])


def rounds(settings):
    return Rounds(PROBLEMS, [], [ONE, OTHER], settings, lambda text: None, None)


@pytest.mark.parametrize(("left", "said"), [(0.0029, False), (0.0031, True)])
def test_a_search_goes_on_while_the_verdict_would_miss_something(left, said):
    """The current alone is met here (2 mA of a floor of 3): what the length shows counts too."""
    last = replace(rung([ONE], 0.002, 0.002), errors=np.full(20, left**2))
    search = Search(last, [rung([], 0.010, 0.010), last])
    assert rounds(Settings()).goes_on(search) is said


@pytest.mark.parametrize(
    ("error", "always", "said"),
    [(0.0029, False, False), (0.0029, True, True), (0.0031, False, True)],
)
def test_a_search_begins_where_the_error_could_hold_an_effect(error, always, said):
    base = rung([], error, error)
    assert rounds(Settings(always=always)).goes_on(Search(base, [base])) is said
