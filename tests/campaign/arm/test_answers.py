"""The answer key knows every kind of the emulator and only effects of the library."""

import pytest

from spirob.campaign.arm.rates import ANSWERS, right
from spirob.effects import all_effects
from spirob.emulator import hidden


def test_every_kind_has_an_answer():
    assert set(ANSWERS) == set(hidden.effects())


def test_every_answer_is_an_effect():
    assert {name for names in ANSWERS.values() for name in names} - set(all_effects()) <= {""}


@pytest.mark.parametrize(
    ("truth", "named", "is_right"),
    [
        ("none", "", True),
        ("none", "creep", False),
        ("cogging", "cogging", True),
        ("cogging", "", False),
        ("cogging:0.5+joint_creep", "joint_viscoelasticity", True),
    ],
)
def test_right(truth, named, is_right):
    assert right(truth, named) is is_right
