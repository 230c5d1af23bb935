"""The comparison of composed laws with PySINDy and a symbolic regression."""

import numpy as np
import pytest

from spirob.campaign.other_laws import Samples, by_sindy, by_symbols, cases
from spirob.campaign.simulators import SIMULATORS


def side(seed, count=600):
    """A cubic spring beside one fitted number, and noise of a hundredth."""
    random = np.random.default_rng(seed)
    motion = random.uniform(-1.0, 1.0, (count, 5))
    slopes = motion[:, 1:2]
    left = motion[:, 0] ** 3 + 0.5 * slopes[:, 0] + 0.01 * random.standard_normal(count)
    return Samples(left, slopes, motion)


def test_a_law_is_judged_with_the_fitted_numbers_moved_by_it():
    train, held = side(1), side(2)
    law, other = (s.motion[:, :1] ** 3 for s in (train, held))
    assert train.after(held, law, other) == pytest.approx(0.01, rel=0.1)
    nothing = np.zeros((600, 1))
    assert train.after(held, nothing, nothing) == pytest.approx(
        np.std(held.motion[:, 0] ** 3), rel=0.1
    )


def test_every_kind_outside_of_the_library_is_played_where_it_can_be():
    found = list(cases([1, 2]))
    assert len({c.name for c in found}) == len(found)
    assert {c.simulator for c in found} == set(SIMULATORS)


def test_both_find_a_plain_law():
    pytest.importorskip("pysindy")
    pytest.importorskip("pyoperon")
    train, held = side(3), side(4)
    assert by_sindy(train, held)[0] < 0.02
    assert by_symbols(train, held, 0)[0] < 0.02
