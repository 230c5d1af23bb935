"""What counts as an effect; of those that do about equally well the simplest is taken."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spirob.diagnosis.criteria import ArmCriteria, Criteria, Worth
from spirob.effects import find_effects
from spirob.identify.builds import RESOLUTION
from tests.diagnosis import machines

WORTH = Worth(Criteria(), 1e-3)
BEFORE = np.random.default_rng(1).uniform(0.8, 1.2, 24)


def model(errors):
    return SimpleNamespace(errors=errors, mean_square=float(np.mean(errors)))


def test_one_block_with_a_blow_does_not_hide_what_all_others_show():
    after = 0.3 * BEFORE
    after[5] = 9.0
    assert WORTH.matters(model(BEFORE), model(after))
    after[5] = 30.0  # but a mean that rises is no fall, whatever the others show
    assert not WORTH.matters(model(BEFORE), model(after))


def test_one_block_alone_proves_nothing():
    after = BEFORE * np.random.default_rng(2).uniform(0.9, 1.1, 24)
    before = np.append(BEFORE, 40.0)
    assert not WORTH.matters(model(before), model(np.append(after, 2.0)))


@pytest.mark.parametrize("rows", [(24, 20), (20, 24)])
def test_errors_over_other_blocks_are_compared_by_their_mean(rows):
    """As of a search about another delay, which leaves other rows a partner."""
    before, after = (np.random.default_rng(n).uniform(0.8, 1.2, n) for n in rows)
    assert WORTH.matters(model(before), model(0.7 * after))
    assert not WORTH.matters(model(before), model(0.99 * after))


def test_noise_seldom_passes():
    """Two tests at 2.5 % each, of 24 blocks: chance alone passes one in twenty, or hardly more."""
    draws = np.random.default_rng(3).normal(0.0, 0.5, (300, 24))
    passed = [WORTH.matters(model(BEFORE), model(BEFORE * np.exp(d))) for d in draws]
    assert np.mean(passed) < 0.1


SIMPLE, RICH = find_effects(["current_offset", "capstan_friction"])  # 1 number; 2 and a memory
FLOOR = Worth(Criteria(floor=0.1), 0.1)


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        (0.110, 0.060, False),  # 0.092 of 0.1, whatever share that is
        (0.200, 0.150, True),  # 0.132
        (0.600, 0.590, False),  # 0.109, 3 % of the square
    ],
)
def test_an_effect_has_to_be_large_by_itself_and_of_what_is_missed(before, after, said):
    one, two = (machines.model([SIMPLE] * k, e) for k, e in enumerate((before, after)))
    assert FLOOR.matters(one, two) is said
    assert not FLOOR.matters(two, one)


def simplest(simple, rich, **rules):
    """Which of two is taken, that leave these errors."""
    worth = Worth(replace(Criteria(), **rules), 0.01)
    models = [machines.model([SIMPLE], simple), machines.model([RICH], rich)]
    return worth.simplest(models).effects[0]


def test_fewer_numbers_win_where_both_do_as_well():
    assert simplest(0.050, 0.050) is SIMPLE
    assert simplest(0.050, 0.0499) is SIMPLE


@pytest.mark.parametrize(
    ("rich", "richer", "winner"),
    [
        (0.0485, 1.0, RICH),  # better by 0.012 of the least size of 0.01
        (0.0492, 1.0, SIMPLE),  # by 0.0089
        (0.0487, 0.0, RICH),  # 5.1 % of the square, of whatever size
        (0.0489, 0.0, SIMPLE),  # 4.3 %
        (0.0485, 2.0, SIMPLE),
    ],
)
def test_a_richer_law_has_to_be_better_by_the_size_that_is_asked(rich, richer, winner):
    assert simplest(0.050, rich, richer=richer) is winner


@pytest.mark.parametrize(
    ("held", "winner"),
    [
        (0.0538, SIMPLE),  # held out 0.020 of the least size of 0.01 more than the 0.050 of SIMPLE
        (0.0505, RICH),  # 0.007, within what counts
        (0.045, RICH),
    ],
)
def test_a_richer_law_that_the_held_out_trials_contradict_is_no_better(held, winner):
    models = [machines.model([SIMPLE], 0.050), machines.model([RICH], 0.040, held)]
    assert Worth(Criteria(), 0.01).simplest(models).effects == (winner,)


def test_a_small_gain_makes_a_richer_law_worth_it_only_where_no_size_is_asked():
    assert simplest(0.005, 0.004, richer=0.0) is RICH
    assert simplest(0.005, 0.004, richer=1.0) is SIMPLE


def test_a_gain_that_two_blocks_alone_show_makes_no_richer_law():
    """Of forty; one of eight draws leaves both out."""

    def missing(effect, everywhere, twice):
        errors = np.full(40, everywhere)
        errors[:2] = twice
        one = machines.model([effect], 0.1)
        return replace(one, errors=errors, left=np.sqrt(np.repeat(errors, machines.BLOCK)))

    simple, worth = missing(SIMPLE, 0.010, 0.05), Worth(Criteria(richer=0.0), 0.01)
    assert worth.simplest([simple, missing(RICH, 0.0102, 0.01)]) is simple
    everywhere = missing(RICH, 0.0085, 0.0425)
    assert worth.simplest([simple, everywhere]) is everywhere


@pytest.mark.parametrize(("poor", "winner"), [(0.052, SIMPLE), (0.055, RICH)])
def test_one_that_is_not_the_best_is_left_only_where_that_is_clearly_better(poor, winner):
    """By a tenth of the square: 1 - (0.050/0.052)² is 8 %, of 0.055 17 %; no size counts here."""
    rich = machines.model([RICH], 0.050)
    other = machines.model([SIMPLE], poor)
    worth = Worth(Criteria(richer=1.0), 1e-3 if winner is RICH else 0.1)
    assert worth.simplest([rich, other]).effects == (winner,)


@pytest.mark.parametrize(("held", "winner"), [(0.03, RICH), (0.08, SIMPLE)])
def test_what_the_held_out_trials_halve_beside_another_is_no_choice(held, winner):
    """0.05 with the simple one; less than half the square of 0.08."""
    rich, simple = machines.model([RICH], 0.02, held), machines.model([SIMPLE], 0.05)
    worth = Worth(Criteria(), 0.01)
    assert worth.best([rich, simple]).effects == (winner,)


def test_of_equally_rich_ones_the_better_is_taken():
    (other,) = find_effects(["constant_force"])
    models = [machines.model([SIMPLE], 0.0500), machines.model([other], 0.0499)]
    assert Worth(Criteria(), 0.01).simplest(models) is models[1]


@pytest.mark.parametrize(
    ("heldout", "whole", "open_still"),
    [(0.90, False, False), (0.98, True, False), (1.1, True, True)],
)
def test_held_out_trials_deny_what_they_contradict_and_of_a_whole_set_what_they_do_not_confirm(
    heldout, whole, open_still
):
    before = machines.model([], 0.1, 0.1)
    after = machines.model([SIMPLE], 0.05, 0.1 * heldout)
    worth = Worth(Criteria(veto=0.05), 0.01)
    assert worth.denied(before, after) is whole
    assert worth.denied(before, after, whole=False) is open_still


def test_what_halves_the_error_does_so_held_out_too():
    before = machines.model([], 0.1, 0.1)
    worth = Worth(Criteria(), 0.01)
    assert worth.halves(before, machines.model([SIMPLE], 0.07, 0.07))
    assert not worth.halves(before, machines.model([SIMPLE], 0.07, 0.08))
    assert not worth.halves(before, machines.model([SIMPLE], 0.08, 0.07))


def test_what_is_fitted_at_all_has_to_promise_a_share_of_the_least_size():
    bare = machines.model([], 0.1)
    worth = Worth(Criteria(), 0.01)
    assert worth.possible(bare, 0.1**2 - 0.0051**2, 0.5)
    assert not worth.possible(bare, 0.1**2 - 0.0049**2, 0.5)
    assert worth.possible(bare, 0.1**2 - 0.0001**2, 0.0)


def test_an_arm_is_asked_less_of_a_richer_law_and_no_less_than_its_models_own_resolution():
    """A simulation has no sharp edges that a richer law takes some of."""
    assert (ArmCriteria().floor, ArmCriteria().richer) == (RESOLUTION, 0.0)
    assert (ArmCriteria().share, ArmCriteria().veto) == (Criteria().share, Criteria().veto)


def test_of_equals_the_held_out_trials_refute_what_they_do_not_bear():
    """Two laws that fit alike: the richer is taken where the simpler misses what was not fitted."""
    rich = machines.model([RICH], 0.3, 0.3)
    for missed, taken in ((0.4, SIMPLE), (0.6, RICH)):  # 0.44 of its square is left, and 0.25
        simple = machines.model([SIMPLE], 0.3, missed)
        assert FLOOR.simplest([simple, rich]).effects == (taken,)
    small = [machines.model([e], 0.3, missed) for e, missed in ((SIMPLE, 0.09), (RICH, 0.01))]
    assert FLOOR.simplest(small).effects == (SIMPLE,), "what it misses does not count"
