"""Who else could stand in the place of a chosen effect, by trials that were fitted or held out."""

import pytest

from spirob.diagnosis.rivals import rivals
from spirob.effects import find_effects
from tests.diagnosis.machines import ended, model

CONSTANT, SPRING = find_effects(["constant_force", "parallel_spring"])


@pytest.mark.parametrize(
    ("left", "heldout", "told"),
    [
        (0.0202, 0.015, True),  # a number more, as good where it was fitted, better held out
        (0.0202, 0.0202, False),  # a number more for nothing
        (0.0300, 0.015, True),  # the trials contradict one another
        (0.0300, 0.030, False),
        (0.0202, 0.0199, False),  # by less than counts
    ],
)
def test_who_is_better_held_out_is_a_rival(left, heldout, told, monkeypatch):
    chosen, other = model([CONSTANT], 0.020), model([SPRING], left, heldout)
    search = ended(model([], 0.1), chosen, least=0.001).search
    monkeypatch.setattr(search, "exchanges", lambda of, effect: [other])
    assert other.numbers > chosen.numbers
    assert rivals(search, chosen, CONSTANT) == ([other] if told else [])
