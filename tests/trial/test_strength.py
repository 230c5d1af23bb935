"""Strengths are drawn for every kind, and so that the oracle's gain is as asked."""

import numpy as np
import pytest

from spirob.emulator import hidden
from spirob.trial.strength import LARGEST, LEFT, RATIOS, VISIBLE, drawn_strength


def test_every_kind_has_a_visibility():
    assert set(VISIBLE) == set(hidden.effects()) - {"none"}


@pytest.mark.parametrize("kind", sorted(VISIBLE))
def test_the_error_without_the_effect_stands_in_the_asked_ratio(kind):
    rng = np.random.default_rng(3)
    for _ in range(20):
        strength = drawn_strength(kind, rng)
        ratio = LEFT / np.hypot(LEFT, VISIBLE[kind] * strength)
        assert ratio >= RATIOS[0] - 1e-9
        assert strength == LARGEST or ratio <= RATIOS[1] + 1e-9


def test_nothing_hidden_has_strength_one():
    assert drawn_strength("none", np.random.default_rng(0)) == 1.0
