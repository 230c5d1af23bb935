"""The search on machines whose errors are known: it grows, prunes, exchanges, and stops."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.diagnosis.criteria import Criteria
from spirob.diagnosis.search import Search
from spirob.effects import find_effects
from tests.diagnosis.machines import SAMPLES, Linear

ONE, TWO, THREE, FOUR, FIVE = find_effects(
    ["current_offset", "quadratic_drag", "stretch", "mount_tilt", "supply_sag"]
)
RNG = np.random.default_rng(1)
A, B, C, D = RNG.standard_normal((4, 2 * SAMPLES))
EACH = {ONE: A, TWO: B, THREE: C, FOUR: D}
CRITERIA = Criteria()


def searched(machine, criteria=CRITERIA, candidates=None):
    search = Search(machine, candidates or list(machine.columns), criteria)
    return search, search.run()


def names(model):
    return {e.name() for e in model.effects}


def test_nothing_is_found_where_nothing_is_missing():
    search, found = searched(Linear(np.zeros(2 * SAMPLES), EACH))
    assert found.chosen.effects == ()
    assert found.rungs == [found.chosen] == [search.models.tried[frozenset()]]
    assert {o.effect for o in found.offers} == set(EACH)


def test_what_is_missing_is_found_the_largest_on_the_lowest_rung():
    _, found = searched(Linear(0.03 * A + 0.1 * B, EACH))
    assert [m.effects for m in found.rungs] == [(), (TWO,), (TWO, ONE)]
    assert found.chosen.heldout_square < 0.01 * found.rungs[0].heldout_square
    assert found.rivals == found.equivalents == {ONE.name(): [], TWO.name(): []}
    assert found.offers[0].effect is TWO


def test_a_search_that_has_come_to_a_model_ends_as_the_one_that_came_to_it():
    machine = Linear(0.03 * A + 0.1 * B, EACH)
    search, found = searched(machine)
    again = Search(machine, list(machine.columns), CRITERIA).settled(found.chosen)
    assert again == found
    more = machine.fitted((*found.chosen.effects, THREE), {})  # what does not matter is dropped
    assert search.settled(more).chosen is found.chosen


@pytest.mark.parametrize("most", [0, 1, 2])
def test_no_more_effects_are_added_than_are_asked_for(most):
    _, found = searched(Linear(0.1 * A + 0.1 * B + 0.1 * C, EACH), replace(CRITERIA, most=most))
    assert len(found.chosen.effects) == most


def test_no_more_candidates_of_a_round_are_fitted_than_are_asked_for():
    machine = Linear(0.03 * A + 0.05 * B + 0.07 * C + 0.09 * D, EACH)
    searched(machine, replace(CRITERIA, most=1, finalists=2))
    first = machine.rounds[0]
    assert first == [(FOUR,), (THREE,)]


def test_a_machine_that_is_complete_is_asked_nothing_more():
    """Though another effect would count."""
    machine = Linear(0.1 * A + 0.02 * B, EACH, enough=0.03**2)
    _, found = searched(machine)
    assert names(found.chosen) == {ONE.name()}
    assert all(len(effects) == 1 for effects in machine.rounds[0])
    _, whole = searched(Linear(0.1 * A + 0.02 * B, EACH))
    assert names(whole.chosen) == {ONE.name(), TWO.name()}


def test_a_complete_machine_is_not_searched_at_all():
    machine = Linear(0.02 * A, EACH, enough=0.03**2)
    _, found = searched(machine)
    assert (found.chosen.effects, machine.rounds) == ((), [])


def test_what_is_not_needed_beside_the_others_goes():
    """The first makes nearly the sum of two: beside both of them nothing is left of it."""
    both = {ONE: A + B + 0.2 * C, TWO: A, THREE: B}
    machine = Linear(0.1 * (A + B), both)
    search = Search(machine, list(both), CRITERIA)
    kept = search._pruned(machine.fitted((ONE, TWO, THREE), {}))
    assert names(kept) == {TWO.name(), THREE.name()}


def test_the_first_effect_is_exchanged_for_what_explains_more():
    """Alone it imitates both of the missing ones best; a pair is all that is looked for."""
    both = {ONE: A + 0.5 * B + 0.3 * C, TWO: A, THREE: B}
    machine = Linear(0.1 * A + 0.06 * B, both)
    _, found = searched(machine, replace(CRITERIA, most=2))
    assert frozenset({ONE.name(), THREE.name()}) in machine.tried
    assert [names(m) for m in found.rungs] == [set(), {TWO.name()}, {TWO.name(), THREE.name()}]


@pytest.mark.parametrize("drag", [0.06, 0.0])
def test_a_rich_law_that_does_what_two_plain_ones_do_is_exchanged_for_them(drag):
    """A wide peak of dry friction leaves too little of a drag for another effect to count."""
    peak, dry = find_effects(["stribeck_friction", "coulomb_friction"])
    columns = {peak: A + 9.5 * drag * B, dry: A, TWO: B, THREE: C}
    machine = Linear(0.1 * A + drag * B, columns, only_one=[peak.name(), dry.name()])
    search, found = searched(machine, candidates=[peak, TWO, THREE, dry])
    assert names(found.chosen) == ({dry.name(), TWO.name()} if drag else {dry.name()})
    alone, both = (machine.fitted(effects, {}) for effects in ((peak,), (peak, TWO)))
    assert not search.worth.matters(alone, both)


def test_a_pair_of_which_each_is_needed_stays():
    search, found = searched(Linear(0.1 * A + 0.1 * B, EACH))
    assert search._pruned(found.chosen, whole=True) is found.chosen
    assert search._exchanged(found.chosen) is found.chosen


def test_two_effects_that_only_count_together_are_found_as_a_pair():
    """Almost opposite to each other: alone each makes a tenth of what both make."""
    pair = {ONE: A + 0.1 * B, TWO: A - 0.1 * B, THREE: C}
    machine = Linear(0.04 * B, pair)
    search, found = searched(machine)
    assert names(found.chosen) == {ONE.name(), TWO.name()}
    assert not any(search.worth.matters(found.rungs[0], machine.fitted((e,), {})) for e in pair)


def test_no_pair_is_of_one_kind_of_law():
    pair = {ONE: A + 0.1 * B, TWO: A - 0.1 * B, THREE: C}
    machine = Linear(0.04 * B, pair, only_one=[ONE.name(), TWO.name()])
    _, found = searched(machine)
    assert found.chosen.effects == ()


def test_where_one_more_effect_is_allowed_no_pair_is_tried():
    pair = {ONE: A + 0.1 * B, TWO: A - 0.1 * B, THREE: C}
    machine = Linear(0.04 * B, pair)
    _, found = searched(machine, replace(CRITERIA, most=1))
    assert found.chosen.effects == ()


def test_of_one_kind_of_law_a_machine_has_one():
    same = {ONE: A, TWO: A + 0.3 * B}
    free, held = (
        searched(Linear(0.1 * A + 0.05 * B, same, only_one=only))[1].chosen
        for only in ((), (ONE.name(), TWO.name()))
    )
    assert names(free) == {ONE.name(), TWO.name()}
    assert len(held.effects) == 1


def test_what_says_nothing_plain_is_not_chosen():
    _, found = searched(Linear(0.1 * A, {ONE: A, TWO: A + 0.2 * B}, odd=[ONE.name()]))
    assert names(found.chosen) == {TWO.name()}


def test_what_the_fitted_numbers_make_themselves_is_no_candidate_later_either():
    machine = Linear(0.1 * A + 0.1 * B, EACH, absorbed=[ONE.name()])
    _, found = searched(machine)
    assert names(found.chosen) == {TWO.name()}
    assert ONE not in {o.effect for o in found.offers}
    later = [asked for model, asked in machine.screened if model]
    assert later
    assert all(ONE.name() not in asked for asked in later)


def test_what_held_out_trials_deny_is_told_and_not_chosen():
    """It is there in the fitted half alone; held out it does harm."""
    own = np.r_[np.ones(SAMPLES), np.zeros(SAMPLES)] * A + np.r_[np.zeros(SAMPLES), A[:SAMPLES]]
    machine = Linear(0.1 * np.r_[A[:SAMPLES], np.zeros(SAMPLES)] + 0.1 * B, {ONE: own, TWO: B})
    _, found = searched(machine)
    assert names(found.chosen) == {TWO.name()}
    assert found.vetoed == [ONE.name()]


def test_where_held_out_trials_deny_the_best_the_next_is_asked():
    """Two does what is missing on the fitted trials alone; with it out of the way one is found."""
    imitation = A + 0.2 * B
    imitation[SAMPLES:] = -A[SAMPLES:]
    other = A + 0.6 * C
    machine = Linear(0.1 * A, {TWO: imitation, ONE: other})
    _, found = searched(machine)
    assert names(found.chosen) == {ONE.name()}
    assert found.vetoed == [TWO.name()]


def split(fitted, held):
    """What two halves of the trials hold."""
    return np.r_[fitted[:SAMPLES], held[SAMPLES:]]


def test_what_leaves_twice_as_much_held_out_as_another_is_not_chosen():
    """Two fits the fitted trials better, and one all of them; a fall held out vetoes neither."""
    columns = {TWO: split(A + 0.3 * B, 0.5 * A), ONE: A}
    machine = Linear(0.1 * split(A + 0.3 * B, A), columns)
    search, found = searched(machine)
    one, two = (machine.fitted((e,), {}) for e in (ONE, TWO))
    assert search.worth.clearly(one, two)
    assert not search.worth.denied(found.rungs[0], two)
    assert names(found.chosen) == {ONE.name()}
    assert search._exchanged(one) is one


def test_of_two_that_imitate_each_other_the_held_out_trials_say_which_goes():
    columns = {
        ONE: split(A + 0.3 * D, A + 0.6 * C),
        TWO: split(A + 0.3 * B, 0.4 * A + 1.2 * C),
    }
    machine = Linear(0.1 * split(A + 0.12 * D + 0.18 * B, A + C), columns)
    search, _ = searched(machine)
    found = search.settled(machine.fitted((ONE, TWO), {}))
    one, two = (machine.fitted((e,), {}) for e in (ONE, TWO))
    assert names(found.chosen) == {ONE.name(), TWO.name()}
    assert two.mean_square < one.mean_square
    assert names(search.without_imitations(found, 1e3).chosen) == {ONE.name()}


def test_where_held_out_trials_confirm_too_little_at_the_end_the_next_is_asked():
    """Held out it takes less than what has to be confirmed, which is asked of a whole set alone."""
    imitation = A + 0.2 * B
    imitation[SAMPLES:] = 0.01 * A[SAMPLES:]
    machine = Linear(0.1 * A, {TWO: imitation, ONE: A + 0.6 * C})
    search, found = searched(machine)
    assert not search.worth.denied(found.rungs[0], machine.fitted((TWO,), {}), whole=False)
    assert names(found.chosen) == {ONE.name()}
    assert found.vetoed == [TWO.name()]


def test_what_is_left_of_a_set_has_to_be_plain_too():
    machine = Linear(0.1 * A, {ONE: A, TWO: B})
    search, _ = searched(machine)
    both = machine.fitted((ONE, TWO), {})
    machine.plain = lambda model: names(model) != {ONE.name()}
    assert search._pruned(both).effects == ()


def test_an_exchange_begins_at_the_numbers_of_the_model_that_it_changes():
    machine, begun = Linear(0.1 * A + 0.05 * B, EACH), []
    search, found = searched(machine)
    grown = machine.grown
    machine.grown = lambda current, sets, counts, near=None: (
        begun.append((current.names, near)) or grown(current, sets, counts, near)
    )
    search.exchanges(found.chosen, ONE)
    assert begun == [(frozenset({TWO.name()}), found.chosen)]


def test_what_held_out_trials_deny_alone_they_may_confirm_beside_another():
    """Two laws that go together where they are fitted, and against each other held out."""
    both = np.r_[A[:SAMPLES], -2.0 * A[SAMPLES:]] + 0.5 * C
    machine = Linear(0.1 * A + 0.1 * both, {ONE: A, TWO: both})
    search, found = searched(machine)
    bare = found.rungs[0]
    assert names(found.chosen) == {ONE.name(), TWO.name()}
    assert all(search.worth.denied(bare, machine.fitted((e,), {})) for e in (ONE, TWO))
    assert found.vetoed == []


def test_who_takes_the_place_about_as_well_is_a_rival_and_who_says_the_same_an_equivalent():
    near = {ONE: A, TWO: A + 0.009 * B, THREE: A + 0.014 * C, FIVE: A + 0.04 * D}
    search, found = searched(Linear(0.1 * A, near, noise=0.005))
    assert found.chosen.effects == (ONE,)
    assert found.equivalents == {ONE.name(): [TWO.name()]}  # 0.9 of 1 mA that count as alike
    assert found.rivals == {ONE.name(): [THREE.name()]}
    clearly = search.worth.clearly(search.models.fitted((FIVE,), {}), found.chosen)
    assert clearly, "who is no rival explains clearly less"


def test_the_plainest_dry_friction_is_a_rival_of_a_law_with_fewer_numbers():
    """How it turns round is no law: a dead band in logs of one way is dry friction there."""
    dead, coulomb, stribeck = find_effects(
        ["driver_dead_band", "coulomb_friction", "stribeck_friction"]
    )
    near = {dead: A, coulomb: A + 0.014 * B, stribeck: A + 0.014 * C}
    search, found = searched(Linear(0.1 * A, near, noise=0.005))
    assert found.chosen.effects == (dead,)
    assert search.models.fitted((coulomb,), {}).numbers > found.chosen.numbers
    assert found.rivals == {dead.name(): [coulomb.name()]}


def ranked(machine):
    """How often all candidates were ranked beside the numbers alone."""
    return sum(not model for model, _ in machine.screened)


@pytest.mark.parametrize(("astray", "anew"), [(0.3, 1), (0.03, 0)])
def test_candidates_that_were_ranked_beside_a_poor_fit_are_ranked_once_more(astray, anew):
    """The numbers alone were astray, and what led them back is not needed any more."""
    plain, machine = Linear(0.1 * B, EACH), Linear(0.1 * B, EACH, astray=astray * A)
    (_, right), (_, found) = searched(plain), searched(machine)
    assert machine.rounds[0][0] == ((ONE,) if anew else (TWO,))
    assert ranked(machine) == ranked(plain) + anew
    assert found.chosen.names == right.chosen.names == {TWO.name()}
    assert found.rungs[0] is machine.tried[frozenset()]
    assert (found.offers[0].error == right.offers[0].error) is bool(anew)


def test_numbers_that_stay_astray_are_not_followed_for_ever():
    class Lost(Linear):
        def grown(self, current, sets, counts, near=None):
            found = super().grown(current, sets, counts)
            assert len(self.rounds) < 20, "it has no end"
            self.asked["astray"] = 0.4 ** len(self.rounds) * A
            self.tried[frozenset()] = self._made(())
            return found

    plain, machine = Linear(0.3 * A, EACH), Lost(np.zeros(2 * SAMPLES), EACH, astray=A)
    for one in (plain, machine):
        searched(one, replace(CRITERIA, most=1))
    assert ranked(machine) == ranked(plain) + 1


def test_what_only_led_the_numbers_out_of_a_poor_fit_is_no_effect():
    machine = Linear(np.zeros(2 * SAMPLES), EACH, astray=0.3 * A)
    _, found = searched(machine)
    assert found.chosen.effects == ()
    assert found.chosen is machine.tried[frozenset()]


def test_a_lesser_effect_stands_for_more_where_more_is_left_than_it_took():
    """A law that is not quite the machine's leaves structure, and a second one takes some of it."""
    search, found = searched(Linear(0.1 * A + 0.03 * B, EACH, noise=0.05))
    assert names(found.chosen) == {ONE.name(), TWO.name()}
    assert search.without_imitations(found, 0.1) is None
    lesser = search.without_imitations(found, 0.9)
    assert names(lesser.chosen) == {ONE.name()}
    assert search.without_imitations(lesser, 1.0) is None, "the first effect stays"


def test_a_narrowed_set_keeps_the_rivals_that_its_effects_had():
    search, found = searched(Linear(0.1 * A + 0.03 * B, EACH))
    found.rivals[ONE.name()] = ["creep"]
    narrow = search.narrowed(found, [ONE.name()])
    assert [m.effects for m in narrow.rungs] == [(), (ONE,)]
    assert narrow.rivals == {ONE.name(): ["creep"]}
    assert narrow.offers is found.offers
