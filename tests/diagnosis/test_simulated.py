"""Sets of effects on an arm, fitted in simulation: as the search is told of them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spirob.diagnosis.criteria import Settings, Worth, block_errors, foreseen
from spirob.diagnosis.fitting import Begun, begun, slowest
from spirob.diagnosis.simulated import ROLES, Simulated, modelled
from spirob.effects import find_effects
from spirob.identify.builds import Floor
from spirob.identify.fit import Fit
from spirob.identify.problem import Effort
from tests.identify.known import residual, spirob

FRICTION, OFFSET, GAIN, WAVE = find_effects(
    ["capstan_friction", "current_offset", "current_gain", "cogging"]
)
BARE, AMOUNT, SHIFT = ["winch.efficiency"], "capstan_friction.friction", "current_offset.offset"
TRUE = {AMOUNT: 0.08, SHIFT: 0.04}
SETTINGS = Settings(intervals=False, patience=3)


@pytest.fixture(scope="module")
def arm():
    plant = spirob([FRICTION, OFFSET, GAIN])
    residuals = {role: residual(plant, TRUE, role) for role in ROLES}
    start = begun(residuals["train"], BARE, {}, SETTINGS)

    def models(**told):
        told = {"names": BARE, "settings": SETTINGS, "begun": start} | told
        made = Simulated(residuals, **told)
        made.said = []
        made.progress = made.said.append
        return made

    return models


def yes(before, after):
    return True


def no(before, after):
    return False


def test_the_numbers_alone_are_the_first_model(arm):
    models = arm()
    bare = models.fitted((), {})
    assert bare is models.tried[frozenset()]
    assert (bare.effects, set(bare.fit.estimates)) == ((), set(BARE))
    held = models.heldout(bare.fit.changes)[models.heldout.rows]
    assert bare.heldout_square == pytest.approx(np.mean(held**2))
    told = models.scores(bare)
    assert told["heldout"].rmse == pytest.approx(np.sqrt(bare.heldout_square))
    assert set(told) == set(ROLES)


def test_a_fit_leaves_out_numbers_of_effects_that_are_not_in_the_set(arm):
    models = arm()
    bare = models.fitted((), {})
    models.offers(bare, [FRICTION, OFFSET])
    both = models.fitted((FRICTION, OFFSET), {**bare.fit.changes, **TRUE})
    assert {AMOUNT, SHIFT} <= set(both.fit.estimates)
    one = models.fitted((OFFSET,), both.fit.changes)
    assert not any(n.startswith("capstan_friction.") for n in one.fit.changes)
    assert one.heldout_square > 4.0 * both.heldout_square
    assert models.fitted((OFFSET,), {}) is one, "every model is kept"


def test_numbers_of_an_effect_that_the_machine_holds_stay(arm):
    """They are among those that every set fits."""
    names = [*BARE, AMOUNT]
    models = arm(names=names, begun=begun(arm().train, names, TRUE, SETTINGS))
    (offer,) = models.offers(models.fitted((), {}), [OFFSET])
    one = models.fitted((OFFSET,), offer.values)
    assert {AMOUNT, SHIFT} <= set(one.fit.estimates)
    assert one.fit.changes[AMOUNT] == pytest.approx(0.08, rel=0.1)


def test_candidates_are_offered_once_the_best_first_and_none_for_a_fitted_number(arm):
    """The efficiency, which is fitted, does what the gain of the current does."""
    models = arm()
    bare = models.fitted((), {})
    offers = models.offers(bare, [OFFSET, GAIN, FRICTION])
    assert {o.effect for o in offers} == {FRICTION, OFFSET}
    assert offers[0].error < offers[1].error < bare.mean_square
    assert all(o.new == 1.0 for o in offers)
    assert len(models.said) == 1
    assert [o.effect for o in models.offers(bare, [OFFSET])] == [OFFSET]
    assert len(models.said) == 1, "known from before"


def test_pairs_promise_what_both_do_until_something_was_added_or_little_is_left(arm):
    models = arm()
    bare = models.fitted((), {})
    offers = models.offers(bare, [FRICTION, OFFSET])
    ((error, *pair),) = models.pairs(bare, offers)
    assert pair == offers
    assert error == max(0.0, offers[0].error + offers[1].error - bare.mean_square)
    one = models.fitted((FRICTION,), offers[0].values)
    assert models.pairs(one, models.offers(one, [OFFSET])) == []
    content = arm(settings=replace(SETTINGS, floor=0.9))
    assert content.pairs(bare, offers) == []


def test_what_counts_is_fitted_until_it_settles_and_nothing_else_is(arm):
    briefly, whole = arm(), arm()
    for models, counts in ((briefly, no), (whole, yes)):
        bare = models.fitted((), {})
        offers = models.offers(bare, [FRICTION, OFFSET])
        made = models.grown(bare, [(o,) for o in offers], counts)
        assert [m.effects for m in made] == [(o.effect,) for o in offers]
        assert all(models.tried[m.names] is m for m in made)
    one, settled = (models.tried[frozenset({FRICTION.name()})].fit for models in (briefly, whole))
    assert set(settled.estimates) > set(one.estimates), "with its shapes, too"
    assert settled.cost < one.cost


def test_the_simplest_within_reach_settles_beside_the_leaders(arm, monkeypatch):
    """Who has more numbers is ahead after a brief fit."""

    def made(mean_square, numbers):
        return SimpleNamespace(mean_square=mean_square, numbers=numbers, effects=(FRICTION,))

    best, second, rich, simple, beyond = (
        made(*of) for of in ((1.0, 3), (1.2, 3), (1.5, 4), (3.9, 1), (4.1, 1))
    )
    models, settled = arm(), []
    monkeypatch.setattr(models, "settled", settled.append)
    models._lead([beyond, rich, simple, second, best])
    assert settled == [best, second, simple]


def test_the_same_without_some_names_knows_nothing_of_them(arm):
    models = arm(measure=lambda found: Floor(0.02 if len(found.estimates) == 1 else 0.004, ""))
    bare = models.fitted((), {})
    offers = models.offers(bare, [FRICTION, OFFSET])
    models.grown(bare, [(o,) for o in offers], no)
    models.fitted((FRICTION, OFFSET), TRUE)
    models.offers(models.tried[frozenset({FRICTION.name()})], [OFFSET])
    assert models.least == pytest.approx(0.004 * models.size)
    other = models.without({FRICTION.name()})
    assert set(other.tried) == {frozenset()}, "who leads may be others"
    assert other.fitted((), {}) is bare
    assert other.least == pytest.approx(0.02 * other.size), "what measured the floor is gone"
    left = other.offers(bare, [OFFSET])
    assert left[0].values is next(o.values for o in offers if o.effect is OFFSET)
    assert len(models.tried) == 4, "it stays what it was"
    other.fitted((FRICTION,), TRUE)
    assert len(models.tried) == 4


def test_a_model_gets_its_intervals_once_it_is_chosen(arm):
    models = arm(settings=replace(SETTINGS, intervals=True))
    one = models.fitted((FRICTION,), TRUE)
    last = models.finished(one)
    assert last is not one
    assert models.finished(last) is last is models.tried[one.names]
    number = last.fit.estimates[AMOUNT]
    assert number.low < number.value < number.high
    plain = arm()
    assert plain.finished(plain.fitted((), {})) is plain.tried[frozenset()]


def test_of_laws_of_dry_friction_a_machine_has_one(arm):
    dry = find_effects(["coulomb_friction", "stribeck_friction"])
    assert arm().related(dry[0], dry[1:])
    assert not arm().related(dry[0], [OFFSET])


class Trials:
    """Trials of an effort of 1 A and of a further signal, without noise, that miss as they say."""

    edges, block, effort = np.array([0, 200]), 10, Effort("motor current", "A")
    rows = np.repeat([True, False], 100)
    table = None

    def __call__(self, changes):
        return np.where(self.rows, changes["effort"], changes["further"])

    def measured(self):
        return np.ones(200)

    def raw(self):
        return [np.ones(100)]

    def spaced(self):
        return [1]

    def filter(self, values):
        return values


def known(settings, effort, further=0.0, effects=(), measure=None):
    """A machine whose numbers alone miss that much, and a model of it with these effects."""
    trials = Trials()
    changes = {"effort": effort, "further": further}
    found = Fit(changes, {}, trials(changes), np.zeros((200, 0)), 0.0, 1)
    models = Simulated(dict.fromkeys(ROLES, trials), ["effort"], settings, Begun(found), measure)
    return models, models.added(effects, found)


@pytest.mark.parametrize(("left", "said"), [(0.0029, True), (0.0031, False)])
def test_with_an_effect_a_machine_is_complete_where_all_signals_are(left, said):
    """The current alone is met here (2 mA of a floor of 3): what the length shows counts too."""
    models, one = known(Settings(), 0.002, np.sqrt(left**2 - 0.002**2), [FRICTION])
    assert np.sqrt(one.mean_square) == pytest.approx(left)
    assert models.complete(one) is said


@pytest.mark.parametrize(
    ("error", "always", "said"),
    [(0.0029, False, True), (0.0029, True, False), (0.0031, False, False)],
)
def test_without_any_it_is_complete_where_no_effect_could_count(error, always, said):
    models, bare = known(Settings(always=always), error)
    assert models.complete(bare) is said


def test_where_the_floor_is_measured_an_effect_may_count_by_the_models_resolution():
    models, bare = known(Settings(always=False), 0.004, measure=lambda found: Floor(0.01, ""))
    assert not models.complete(bare)
    assert models.least == pytest.approx(0.01)
    assert not models.lacks(bare)
    assert "up to 1.0%" in models.nothing(bare)


def test_what_is_left_is_above_noise_and_floor_on_the_trials_that_choose_nothing():
    models, one = known(Settings(), 0.006, effects=[FRICTION])
    left = models.left(one)
    assert left.share == pytest.approx(1.0 - 0.003**2 / 0.006**2)
    assert left.said.startswith("Beside it 0.6% of the motor current is left, more than the 0.3%")
    models, one = known(Settings(), 0.0029, effects=[FRICTION])
    assert (models.left(one).share, models.left(one).said) == (0.0, "")


@pytest.mark.parametrize(("order", "slow"), [(0.05, True), (0.0504, True), (0.06, False)])
def test_a_wave_is_known_that_is_as_slow_as_its_bounds_allow(order, slow):
    models, one = known(Settings(), 0.006, effects=[WAVE, FRICTION])
    models.train.table = SimpleNamespace(
        about={"cogging.order": SimpleNamespace(low=0.05)},
        vector=lambda changes: [changes["cogging.order"]],
        position=lambda name: 0,
    )
    one = replace(one, fit=replace(one.fit, changes={"cogging.order": order}))
    assert slowest(models.train, one.effects, one.fit) == [WAVE] * slow
    assert slow or models.plain(one)


BLOCKS, SAMPLES = 40, 20_000


def judged(fitted, decided, numbers=3):
    """A model that misses by these RMS errors of blocks where it was fitted, and where it decides.

    (40,) and (10,)
    """
    own = np.repeat(fitted, SAMPLES // BLOCKS)
    train = SimpleNamespace(
        rows=np.ones(SAMPLES, bool), edges=np.array([0, SAMPLES]), block=SAMPLES // BLOCKS
    )
    found = Fit({}, dict.fromkeys(range(numbers)), own, np.zeros((0, 0)), 0.0, 1)

    class Decides:
        rows, edges, block = np.ones(100, bool), np.array([0, 100]), 10

        def __call__(self, changes):
            return np.repeat(decided, 10)

    trials = {"train": train, "validate": Decides(), "heldout": Decides()}
    return modelled([FRICTION], found, trials)


FLAT, FEW = np.ones(BLOCKS), np.ones(10)
WORTH = Worth(Settings(), 0.1)


def rare(fitted, decided):
    """One that misses by one, and by more in one of ten blocks of either kind."""
    own, few = FLAT.copy(), FEW.copy()
    own[:4], few[0] = fitted, decided
    return judged(own, few)


def test_an_effect_in_one_block_of_ten_counts_where_the_fitted_trials_show_it_too():
    """Of ten blocks alone a third of the draws leave it out."""
    assert WORTH.matters(rare(5.0, 5.0), rare(1.0, 1.0))
    assert not WORTH.matters(rare(5.0, 1.0), rare(1.0, 1.0)), "it is not there where that decides"


def test_an_effect_that_the_fitted_trials_do_not_show_is_not_sure():
    """One block of ten, and of the fitted ones hardly more than chance."""
    noise = np.random.default_rng(1).uniform(0.7, 1.4, BLOCKS)
    before, after = judged(noise[::-1], FEW), judged(noise, FEW)
    before.errors[0], before.left[:10] = 2.0**2, 2.0
    assert not WORTH.matters(before, after)


def test_what_more_numbers_fit_by_themselves_does_not_count():
    """Errors of fitted trials are foreseen as they would be on new ones."""
    found = judged(FLAT, FEW, numbers=900)
    own = block_errors(np.ones(SAMPLES), np.array([0, SAMPLES]), SAMPLES // BLOCKS)
    assert found.errors[10:] == pytest.approx(foreseen(own, 900, SAMPLES // 10))
    assert found.errors[10:].min() > 2.0
    assert found.errors[:10] == pytest.approx(1.0)
    assert found.mean_square == pytest.approx(1.0)
