"""What counts as an effect; of those that do about equally well the simplest is taken."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from spirob.diagnosis.rungs import Confirmed, Settings
from spirob.diagnosis.weighing import counts, least_of, periodic, simplest

from spirob.effects import find_effects

SIMPLE, RICH = find_effects(["current_offset", "capstan_friction"])
BLOCKS, BLOCK = 40, 500
TRAIN = SimpleNamespace(
    rows=np.ones(BLOCKS * BLOCK, bool), edges=np.array([0, BLOCKS * BLOCK]), block=BLOCK
)
VALIDATE = SimpleNamespace(  # an effort of 1 without noise
    rows=np.ones(10, bool),
    measured=lambda: np.ones(10),
    raw=lambda: [np.ones(10)],
    filter=lambda values: values,
)
PROBLEMS = {"train": TRAIN, "validate": VALIDATE}
ERRORS = np.random.default_rng(0).uniform(0.5, 1.5, 10)  # of the few validation blocks


def found(effect, numbers, fitted_error, validated=ERRORS):
    residual = np.random.default_rng(1).normal(0.0, fitted_error, BLOCKS * BLOCK)
    fit = SimpleNamespace(estimates=dict.fromkeys(range(numbers)), residual=residual)
    return Confirmed((effect,), 0.0, fit, np.zeros(1), validated, {})


def chosen(simple, rich):
    return simplest([simple, rich], TRAIN, Settings()).effects[0]


def test_fewer_numbers_win_where_both_do_as_well():
    assert chosen(found(SIMPLE, 3, 1.0), found(RICH, 6, 1.0)) is SIMPLE
    slightly = ERRORS * np.where(np.arange(10) % 2, 1.05, 0.94)
    assert chosen(found(SIMPLE, 3, 1.0), found(RICH, 6, 1.0, slightly)) is SIMPLE


@pytest.mark.parametrize(("draws", "winner"), [(0.94, SIMPLE), (0.96, RICH)])
def test_more_numbers_have_to_do_better_in_nineteen_of_twenty_draws(monkeypatch, draws, winner):
    monkeypatch.setitem(simplest.__globals__, "beaten", lambda *_: draws)
    assert chosen(found(SIMPLE, 3, 1.01), found(RICH, 6, 1.0)) is winner


def test_a_short_validation_that_cannot_tell_is_overruled_by_the_fitted_trials():
    assert chosen(found(SIMPLE, 3, 1.2), found(RICH, 6, 1.0)) is RICH


def test_what_more_numbers_fit_by_themselves_does_not_count():
    samples = BLOCKS * BLOCK // 10
    overfitted = 1.0 - 0.1 * 900 / samples
    assert chosen(found(SIMPLE, 3, 1.0), found(RICH, 900, overfitted)) is SIMPLE


def rare(fitted, validated):
    """A model that misses by one everywhere, and by more in one of ten blocks of either kind."""
    found_ = found(SIMPLE, 3, 1.0, np.where(np.arange(10) % 10 == 0, validated, 1.0) ** 2)
    found_.fit.residual[: BLOCKS * BLOCK // 10] *= fitted
    return found_


def test_an_effect_in_one_block_of_ten_counts_where_the_fitted_trials_show_it_too():
    """Of ten blocks alone a third of the draws leave it out."""
    less = replace(Settings(), floor=0.1)
    assert counts(rare(1.0, 1.0), rare(5.0, 5.0), PROBLEMS, less)
    assert not counts(rare(1.0, 1.0), rare(1.0, 5.0), PROBLEMS, less)


def test_what_only_the_fitted_trials_show_does_not_count():
    assert not counts(rare(1.0, 1.0), rare(5.0, 1.0), PROBLEMS, Settings())


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        (0.110, 0.060, False),  # 0.092 of 0.1, though it makes the model complete
        (0.200, 0.150, True),  # 0.132, whatever is left
    ],
)
def test_what_builds_imitate_does_not_count(before, after, said):
    less = replace(Settings(), floor=0.1)
    one, two = (found(SIMPLE, 3, 100 * e, np.full(10, e**2)) for e in (before, after))
    assert counts(two, one, PROBLEMS, less) is said


def test_each_of_two_needs_a_share_of_what_was_added_first():
    """Of the first alone where they came one by one, of both where they came together."""
    base, *rungs = (SimpleNamespace(errors=np.full(10, e**2)) for e in (0.5, 0.4, 0.3))
    search = SimpleNamespace(rungs=[base])
    assert least_of(search, VALIDATE, Settings()) is None
    search.rungs.append(rungs[0])
    assert least_of(search, VALIDATE, Settings()) == pytest.approx(0.25 * 0.3)
    search.rungs = [base, rungs[1]]
    assert least_of(search, VALIDATE, Settings()) == pytest.approx(0.25 * 0.4)


def test_a_second_effect_needs_half_the_floor_where_the_first_is_small():
    rungs = [SimpleNamespace(errors=np.full(10, e**2)) for e in (0.005, 0.003)]
    least = least_of(SimpleNamespace(rungs=rungs), VALIDATE, Settings())
    assert least == pytest.approx(0.5 * 0.003)  # of an effort of 1


@pytest.mark.parametrize(("order", "said"), [(0.05, False), (0.0504, False), (0.06, True)])
def test_a_wave_as_slow_as_its_bounds_allow_is_none(order, said):
    (wave,) = find_effects(["cogging"])
    about = {"cogging.order": SimpleNamespace(low=0.05)}
    table = SimpleNamespace(
        about=about, vector=lambda changes: [changes["cogging.order"]], position=lambda name: 0
    )
    fit = SimpleNamespace(changes={"cogging.order": order})
    one = Confirmed((wave, SIMPLE), 0.0, fit, np.zeros(1), ERRORS, {})
    assert periodic(one, SimpleNamespace(table=table)) is said
