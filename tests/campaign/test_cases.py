"""What is drawn: reproducible, as strong as is meant, with an answer key that the library knows."""

import numpy as np
import pytest

from spirob.campaign import case as drawing
from spirob.campaign.case import HIGH, LOW, Case, able, cases, drawn, strength, together
from spirob.campaign.recorder import share
from spirob.campaign.scoring import KINDS, LIBRARY, OUTSIDE, answers
from spirob.campaign.simulators import SIMULATORS
from spirob.campaign.simulators.motion import FINE, Motion
from spirob.effects import all_effects
from spirob.machine.description.rig import RigFile

UNSEEN = {"current_gain"}  # what is fitted takes it up


@pytest.fixture
def short(monkeypatch):
    """Short logs of 500 Hz, that a test can afford."""
    monkeypatch.setattr("spirob.campaign.case.RATES", (500.0,))
    monkeypatch.setattr("spirob.campaign.case.length_of", lambda rate, rng: 4.0)


def player(kind):
    return next(name for name in ("bench", "rigid", "two_mass", "arm") if able(name, kind))


@pytest.mark.parametrize("kind", [k for k in KINDS if k not in UNSEEN])
def test_every_kind_shows_in_the_effort_as_much_as_is_drawn(kind, short):
    for seed in range(6):  # a machine's motion may be one that does not show it; most do
        truth = drawn(Case(player(kind), kind, seed)).truth
        if 0.9 * LOW <= truth["share"] <= 1.1 * HIGH:
            assert truth["can_be_shown"]
            assert truth["shares"][kind] == pytest.approx(truth["share"], rel=1e-6)
            return
    pytest.fail(f"{kind} shows {truth['share']:.1%}")


def test_a_gain_cannot_be_seen_and_the_answer_says_so(short):
    truth = drawn(Case("rigid", "current_gain", 1)).truth
    assert truth["share"] < 0.01
    assert not truth["can_be_shown"]


def test_nothing_hidden_leaves_nothing(short):
    for name in SIMULATORS:
        truth = drawn(Case(name, "none", 3)).truth
        assert truth["share"] < 0.03, name
        assert truth["must"] == []
        assert truth["can_be_shown"]


def test_a_case_is_the_same_again_and_another_seed_is_another_machine(short):
    one, again, other = (drawn(Case("bench", "two", seed)) for seed in (4, 4, 5))
    assert one.rig == again.rig
    assert one.truth == again.truth
    for name, column in one.test.items():
        np.testing.assert_array_equal(column, again.test[name])
    assert other.about != one.about


def test_the_description_is_one_that_the_diagnosis_reads(short):
    for name in SIMULATORS:
        for seed in range(4):
            made = drawn(Case(name, "none", seed))
            rig = RigFile.model_validate(made.rig)
            assert set(rig.columns()) == set(made.test)
            for given in rig.fit.values():
                assert given.low < given.nominal < given.high


def test_what_is_drawn_together_can_be_together():
    for kind, many in (("two", 2), ("three", 3)):
        for name in SIMULATORS:
            chosen = [Case(name, kind, seed).kinds() for seed in range(20)]
            assert len(set(chosen)) > 10
            for kinds in chosen:
                assert len(kinds) == many
                assert together(kinds)
                assert set(kinds) <= set(LIBRARY) & SIMULATORS[name].kinds


def test_beside_an_effect_of_the_library_is_one_that_it_lacks():
    for name in SIMULATORS:
        for seed in range(10):
            own, strange = Case(name, "beside", seed).kinds()
            assert own in LIBRARY
            assert strange in OUTSIDE
            assert together([own, strange])


def test_what_is_beside_shows_less_and_only_the_other_has_a_name(short):
    truth = drawn(Case("bench", "beside", 0)).truth
    own, strange = truth["hidden"]
    assert truth["inside"]
    assert truth["beside"]
    assert own in truth["must"][0]
    assert truth["shares"][strange] < 0.7 * truth["shares"][own]


def test_every_right_answer_is_a_name_of_the_library():
    for kind in KINDS:
        for bristles in (False, True):
            for one_way in (False, True):
                key = answers(kind, bristles, one_way)
                assert key.names | key.besides | key.near <= set(all_effects())
                assert not key.names & key.near
    assert all(kind in KINDS[kind].names for kind in LIBRARY)
    assert len(OUTSIDE) >= 8
    assert not set(OUTSIDE) & set(all_effects())


def test_dry_friction_one_way_is_a_constant_force():
    assert "constant_force" in answers("coulomb_friction", False, one_way=True).names
    assert "constant_force" not in answers("coulomb_friction", False, one_way=False).names


def test_each_simulator_plays_what_it_can_and_nulls_are_machines_of_their_own():
    chosen = cases(["rigid", "bench"], ["backlash", "torque_ripple", "none"], [3, 4], nulls=3)
    names = [c.name for c in chosen]
    assert len(set(names)) == len(names)
    assert not any("backlash" in name for name in names)
    assert sum("torque_ripple" in name for name in names) == 2
    assert {c.seed for c in chosen if c.kind == "none"} == {3, 4, 5}
    assert len(cases(["two_mass"], [], [0])) == 4 + len(SIMULATORS["two_mass"].kinds) - 1


def test_the_share_is_what_inertia_and_viscous_friction_cannot_take_up():
    t = np.arange(int(8 * FINE)) / FINE
    q = np.sin(2 * np.pi * t)
    v, a = np.gradient(q, 1 / FINE), np.gradient(np.gradient(q, 1 / FINE), 1 / FINE)
    plain, force = 0.3 * a + 2.0 * v, 5.0
    assert share([Motion(q, v, plain)], 500.0) < 1e-4
    found = share([Motion(q, v, plain + force)], 500.0)
    whole = np.sqrt(np.mean((plain + force)[2500:-2500] ** 2))
    assert found == pytest.approx(force / whole, rel=0.02)
    known = Motion(q, v, plain + force, {}, lambda read: np.full_like(read, force))
    assert share([known], 500.0) < 1e-4


@pytest.mark.parametrize(
    "law", [lambda s: s / (s + 3), lambda s: 0.02 * s**2, lambda s: 0.5 * s**0.3]
)
def test_a_strength_is_found_whatever_the_law(law):
    at, shown = strength(law, 0.25, 30.0)
    assert shown == law(at)
    assert shown == pytest.approx(0.25, rel=0.15)


def test_a_strength_ends_at_the_most_there_is():
    assert strength(lambda s: 0.1 * s, 0.3, 2.0) == (2.0, 0.2)


def test_what_cannot_be_seen_is_not_made_a_monster_of():
    at, shown = strength(lambda s: 0.001 * s, 0.3, 30.0)
    assert shown < drawing.SEEN
    assert at < 1.0


def test_a_described_arm_whose_encoder_is_off_centre_shows_it(short):
    """What the body is known to need is taken at the place as read, and is wrong there."""

    def shares(kind):
        made = [drawn(Case("arm", kind, seed)) for seed in range(4)]
        return [one.truth["share"] for one in made if one.about["described"]]

    assert min(shares("encoder_eccentricity")) > 5.0 * max(shares("none"))
