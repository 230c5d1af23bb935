"""A law alone outdoes names where it is plainer than they and halves what they leave."""

from types import SimpleNamespace

import numpy as np
import pytest

from spirob.diagnosis.certainty import Ended
from spirob.diagnosis.conclusion import Weighed
from spirob.diagnosis.criteria import Criteria, Worth
from spirob.diagnosis.model import Found
from spirob.effects import all_effects
from spirob.identify.intervals import Estimate
from spirob.machine.laws.presliding_friction import PreslidingFriction
from spirob.machine.laws.stribeck_friction import StribeckFriction
from spirob.machine.search import dry_friction, judging, leftovers
from spirob.machine.search.dry_friction import with_dry, with_instant, with_plainer
from spirob.machine.search.judging import (
    confirmed,
    contradicted,
    explains_all,
    foretelling,
    may_outdo,
    numbers,
    outdone,
)
from tests.diagnosis import machines


def model(*names, told=(), left=1.0):
    """A fitted model in which these numbers alone are told beside nothing."""
    effects = tuple(all_effects()[name] for name in names)
    estimates = {}
    for effect in effects:
        for field, about in effect.parameters().items():
            full, zero = f"{effect.name()}.{field}", effect.neutral.get(field, about.nominal)
            low, high = (1.0, 2.0) if full in told else (zero - 1.0, zero + 1.0)
            estimates[full] = Estimate(0.5 * (low + high), low, high, about.unit, False)
    return SimpleNamespace(
        effects=effects,
        names=frozenset(names),
        fit=SimpleNamespace(estimates=estimates),
        mean_square=left,
    )


ONE_WAVE = model("cogging", told=("cogging.sine", "cogging.cosine"))
THREE_WAVES = model(
    "cogging",
    told=[f"cogging.{n}{w}" for n in ("", "second_", "third_") for w in ("sine", "cosine")],
)


def test_numbers_are_those_that_are_told_and_their_shapes():
    assert numbers(ONE_WAVE) == 3  # two amplitudes and the order
    assert numbers(THREE_WAVES) == 9
    assert numbers(model("cogging")) == 0
    assert numbers(model("quadratic_drag", told=("quadratic_drag.drag",))) == 1
    bristle = all_effects()["presliding_friction"]
    assert bristle.state
    told = [f"presliding_friction.{f}" for f in bristle.neutral]
    assert numbers(model("presliding_friction", told=told)) == len(bristle.parameters()) + 1
    assert numbers(model("presliding_friction")) == 0
    both = model("presliding_friction", "quadratic_drag", told=("quadratic_drag.drag",))
    assert numbers(both) == numbers(both, {"quadratic_drag"}) == 1
    assert numbers(both, {"presliding_friction"}) == 0


LEAST = 0.02  # squared size of the least that counts


class Stub:
    """Answers the questions of the criteria by the errors."""

    def halves(self, before, after):
        return after.mean_square < 0.5 * before.mean_square

    def matters(self, before, after):
        return before.mean_square - after.mean_square > LEAST


def leaving(left, of, terms=1):
    return SimpleNamespace(model=SimpleNamespace(**{**vars(of), "mean_square": left}), terms=terms)


@pytest.mark.parametrize(
    ("alone", "left", "beside_left", "out"),
    [
        (ONE_WAVE, 0.1, 0.1, True),
        (ONE_WAVE, 0.1, None, True),  # nothing is composed beside the names
        (ONE_WAVE, 0.6, 0.6, False),  # it leaves too much
        (ONE_WAVE, 0.1, 0.09, True),  # the names with their law leave less, by nothing that counts
        (ONE_WAVE, 0.1, 0.05, False),  # by what counts
        (THREE_WAVES, 0.1, 0.1, False),  # it is no plainer
        (THREE_WAVES, 0.1, 0.3, True),  # but leaves less than half
    ],
)
def test_a_plainer_law_that_halves_what_is_left_outdoes_names(alone, left, beside_left, out):
    law = leaving(left, alone)
    beside = leaving(beside_left, THREE_WAVES) if beside_left is not None else None
    assert outdone(Stub(), THREE_WAVES, beside, law) is out
    assert not outdone(Stub(), THREE_WAVES, beside, None)


@pytest.mark.parametrize(("terms", "out"), [(1, True), (2, True), (3, False), (4, False)])
@pytest.mark.parametrize("left", [0.1, 0.3])
def test_a_law_of_as_many_terms_as_a_name_and_its_law_takes_no_name_away(terms, left, out):
    """Of four terms that have few numbers that are told one says what the name does."""
    together = leaving(left - 0.01, THREE_WAVES, terms=2)
    assert outdone(Stub(), THREE_WAVES, together, leaving(left, ONE_WAVE, terms)) is out


def test_names_that_tell_nothing_beside_their_law_are_outdone_by_one_no_plainer():
    named = model("tip_payload", left=1.0)
    together = model("tip_payload", "cogging", told=("cogging.sine", "cogging.cosine"), left=0.1)
    law = leaving(0.1, ONE_WAVE)
    assert outdone(Stub(), named, leaving(0.1, together), law)
    payload = [f"tip_payload.{field}" for field in all_effects()["tip_payload"].neutral]
    told = model(
        "tip_payload", "cogging", told=("cogging.sine", "cogging.cosine", *payload), left=0.1
    )
    assert not outdone(Stub(), named, leaving(0.1, told), law)


@pytest.mark.parametrize(
    ("left", "heldout", "whole"), [(0.01, 0.01, True), (0.05, 0.01, False), (0.01, 0.05, False)]
)
def test_a_law_explains_all_where_it_leaves_nothing_that_counts(left, heldout, whole):
    law = SimpleNamespace(model=SimpleNamespace(mean_square=left**2, heldout_square=heldout**2))
    assert explains_all(SimpleNamespace(least=0.02), law) is whole
    assert not explains_all(SimpleNamespace(least=0.02), None)


@pytest.mark.parametrize(("much", "named"), [(True, "unknown"), (False, "named")])
def test_a_name_beside_which_much_is_left_gives_way_to_a_law_that_explains_all(
    much, named, monkeypatch
):
    law = leaving(1e-6, model("cogging", told=("cogging.sine", "cogging.cosine"), left=1e-6))
    chosen = model("tip_payload", left=1.0)
    for name, found in {
        "structured": lambda models, model, rest: True,
        "unexplained": lambda models, model: much,
        "composed": lambda search, found, base, *wanted: law if wanted else None,
        "outdone": lambda *of: False,
        "explains_all": lambda worth, alone: alone is law,
        "_by_law": lambda judged, law, said: SimpleNamespace(verdict="unknown", law=law),
    }.items():
        monkeypatch.setattr(judging, name, found)
    search = SimpleNamespace(models=None, worth=None)
    found = SimpleNamespace(chosen=chosen, rungs=[None])
    verdict = SimpleNamespace(kind="named")
    judged = judging.Judged(SimpleNamespace(search=search), found, verdict, None)
    told = judging._beside_laws(judged).verdict
    assert getattr(told, "kind", told) == named


@pytest.mark.parametrize(("left", "may"), [(0.9, True), (1.1, False)])
def test_a_draft_that_leaves_more_than_the_names_is_not_fitted(left, may):
    assert may_outdo(THREE_WAVES, SimpleNamespace(mean_square=left)) is may


@pytest.mark.parametrize("gentler", [1.0, 0.3, 3.0])
@pytest.mark.parametrize(("left", "counts"), [(0.15, True), (0.05, False)])
def test_what_is_left_counts_beside_the_effort_of_the_held_out_logs(
    gentler, left, counts, monkeypatch
):
    monkeypatch.setattr(leftovers, "noise_floor", lambda problem: 1e-3)
    heldout = SimpleNamespace(measured=lambda: np.full(10, gentler))
    models = SimpleNamespace(train=None, heldout=heldout, size=1.0, least=1e-3)
    model = SimpleNamespace(heldout_square=(left * gentler) ** 2, mean_square=0.0)
    assert leftovers.unexplained(models, model) is counts


@pytest.mark.parametrize(("left", "counts"), [(0.15, True), (0.05, False)])
def test_what_is_left_of_fitted_logs_left_out_counts_beside_their_effort(left, counts, monkeypatch):
    monkeypatch.setattr(leftovers, "noise_floor", lambda problem: 1e-3)
    heldout = SimpleNamespace(measured=lambda: np.full(10, 1.0))
    models = SimpleNamespace(train=None, heldout=heldout, size=3.0, least=1e-3)
    model = SimpleNamespace(heldout_square=0.09**2, mean_square=(3.0 * left) ** 2)
    assert leftovers.unexplained(models, model) is counts


@pytest.mark.parametrize(("heldout", "stands"), [(0.5, True), (0.97, False), (1.2, False)])
def test_names_that_the_held_out_logs_deny_as_a_whole_do_not_stand(heldout, stands):
    bare, chosen = SimpleNamespace(heldout_square=1.0), SimpleNamespace(heldout_square=heldout)
    search = SimpleNamespace(
        worth=Worth(Criteria(), 0.1),
        models=SimpleNamespace(left=lambda model: None),
        narrowed=lambda found, names: Found([found.rungs[0]]),
    )
    told = {"cogging": Weighed(0.8, 0.9)}
    ended, weighed = confirmed(Ended(search, Found([bare, chosen]), None), told)
    assert ended.found.chosen is (chosen if stands else bare)
    assert weighed["cogging"].probability == (0.8 if stands else 0.0)


@pytest.mark.parametrize("others", [("cogging",), ()])
@pytest.mark.parametrize("misleads", [True, False])
def test_a_name_that_misleads_falls_and_others_are_weighed_again(misleads, others, monkeypatch):
    chosen, lesser = model("gear_compliance", *others), model(*others)
    found = ["gear_compliance"] if misleads else []
    again = {name: Weighed(0.7, 0.7) for name in others}
    monkeypatch.setattr(judging, "misleading", lambda search, chosen, names: found)
    monkeypatch.setattr(judging, "weigh", lambda ended, bent: again)
    search = SimpleNamespace(
        worth=SimpleNamespace(denied=lambda before, after: False),
        models=SimpleNamespace(left=lambda model: None),
        narrowed=lambda found, names: Found([lesser] * (names == [*others])),
    )
    told = {name: Weighed(0.9, 0.9) for name in ("gear_compliance", *others)}
    ended, weighed, said = foretelling(Ended(search, Found([model(), chosen]), None), told)
    assert ended.found.chosen is (lesser if misleads else chosen)
    shaft = weighed.pop("gear_compliance")
    assert shaft.probability == (0.0 if misleads else 0.9)
    assert {one.probability for one in weighed.values()} <= {0.7 if misleads else 0.9}
    assert ("torsional compliance of the gear" in said) is misleads


@pytest.mark.parametrize("bent", [True, False])
def test_dry_friction_of_another_shape_is_denied_and_so_is_a_lag_that_a_delay_undoes(
    bent, monkeypatch
):
    monkeypatch.setattr(judging, "is_bent", lambda search, model: bent)
    monkeypatch.setattr(judging, "only_smoothing", lambda model, rig, period: {"current_lag"})
    made = machines.model([all_effects()[n] for n in ("coulomb_friction", "cogging")], 0.1)
    train = SimpleNamespace(recordings=[SimpleNamespace(period=2e-3)], rig=None)
    search = SimpleNamespace(models=SimpleNamespace(train=train))
    told = {"current_lag", "coulomb_friction"} if bent else {"current_lag"}
    assert contradicted(search, made) == told


def test_what_is_unlikely_anyway_stays_the_nearest():
    bare, chosen = SimpleNamespace(heldout_square=1.0), SimpleNamespace(heldout_square=1.2)
    search = SimpleNamespace(worth=Worth(Criteria(), 0.1))
    ended = Ended(search, Found([bare, chosen]), None)
    told = {"cogging": Weighed(0.3, 0.4)}
    assert confirmed(ended, told) == (ended, told)


@pytest.mark.parametrize(
    ("way", "same", "rivals"),
    [(1e-4, ["coulomb_friction"], ["stribeck_friction"]), (1e-2, [], ["coulomb_friction"])],
)
def test_dry_friction_is_told_beside_a_bristle_whose_way_no_log_shows(way, same, rivals):
    """What flips at once is the same; one with a peak beside rest is a rival."""
    coulomb, cogging = (all_effects()[n] for n in ("coulomb_friction", "cogging"))
    made = machines.model([cogging, PreslidingFriction], 0.05)
    made.fit.changes["presliding_friction.presliding"] = way
    search = machines.ended(machines.model([], 1.0), machines.model([cogging], 0.9), made).search
    search.candidates = [StribeckFriction, coulomb, PreslidingFriction]
    search.models.train = SimpleNamespace(sizes=SimpleNamespace(unseen=1e-3, axis_unit="rad"))
    weighed = {
        "cogging": Weighed(0.9, 0.9),
        "presliding_friction": Weighed(0.8, 0.8, [], ["coulomb_friction"]),
    }
    told, said = with_instant(search, made, weighed)
    assert told["cogging"] == weighed["cogging"]
    assert told["presliding_friction"].equivalents == same
    assert told["presliding_friction"].rivals == rivals
    assert told["presliding_friction"].probability == 0.8
    assert bool(said) == bool(same)
    assert not same or ("0.0001 rad" in said and "0.001 rad" in said)


@pytest.mark.parametrize(("low", "rivals"), [(0.0, ["coulomb_friction"]), (0.3, [])])
def test_a_peak_that_may_be_none_is_told_beside_friction_without_one(low, rivals):
    made = machines.model([StribeckFriction], 0.05)
    peak = Estimate(1.0, low, 2.0, "N·m", False)
    made.fit.estimates["stribeck_friction.breakaway_excess"] = peak
    search = machines.ended(machines.model([], 1.0), made).search
    search.candidates = [StribeckFriction, all_effects()["coulomb_friction"]]
    told = with_plainer(search, made, {"stribeck_friction": Weighed(0.8, 0.8)})
    assert told["stribeck_friction"].rivals == rivals


@pytest.mark.parametrize(("softness", "rivals"), [(7.5, ["coulomb_friction"]), (0.5, [])])
def test_a_peak_within_the_soft_sign_of_the_speed_is_none(softness, rivals):
    """The curve never lies above its level at speed, though the peak's own number is plain."""
    made = machines.model([StribeckFriction], 0.05)
    numbers = {"coulomb_torque": 1.3, "breakaway_excess": 5.6, "stribeck_ratio": 2.0}
    for field, value in {**numbers, "softness": softness, "presliding": 1e-5}.items():
        told = Estimate(value, 0.9 * value, 1.1 * value, "1", False)
        made.fit.estimates[f"stribeck_friction.{field}"] = told
    search = machines.ended(machines.model([], 1.0), made).search
    search.candidates = [StribeckFriction, all_effects()["coulomb_friction"]]
    told = with_plainer(search, made, {"stribeck_friction": Weighed(0.9, 0.9)})
    assert told["stribeck_friction"].rivals == rivals


@pytest.mark.parametrize("low", [1e-5, 2e-5])
def test_a_peak_that_flips_at_once_is_no_bristle_that_no_log_shows(low):
    """Its way ends at none that is told from none."""
    coulomb = all_effects()["coulomb_friction"]
    made = machines.model([StribeckFriction], 0.05)
    made.fit.changes["stribeck_friction.presliding"] = 1e-4
    way = Estimate(1e-4, low, 2e-4, "rad", False)
    made.fit.estimates["stribeck_friction.presliding"] = way
    search = machines.ended(machines.model([], 1.0), made).search
    search.candidates = [StribeckFriction, coulomb]
    about = {"stribeck_friction.presliding": SimpleNamespace(low=1e-5)}
    sizes = SimpleNamespace(unseen=1e-3, axis_unit="rad")
    search.models.train = SimpleNamespace(sizes=sizes, table=SimpleNamespace(about=about))
    weighed = {"stribeck_friction": Weighed(0.8, 0.8)}
    told, said = with_instant(search, made, weighed)
    assert told["stribeck_friction"].equivalents == ([] if low == 1e-5 else ["coulomb_friction"])
    assert bool(said) == (low > 1e-5)


@pytest.mark.parametrize(
    ("one_way", "left", "told"),
    [([""], 0.1, True), ([], 0.1, False), ([""], 0.2, False)],
)
def test_dry_friction_is_told_beside_a_constant_of_logs_of_one_way(
    one_way, left, told, monkeypatch
):
    """Where its fit leaves as much; both signs of speed tell them apart, and so does a dwell."""
    monkeypatch.setattr(dry_friction, "one_way", lambda train, heldout: one_way)
    constant, dry = all_effects()["constant_force"], all_effects()["coulomb_friction"]
    sets = machines.model([], 1.0), machines.model([dry], left), machines.model([constant], 0.1)
    ended = machines.ended(*sets)
    ended.search.candidates = [constant, all_effects()["stribeck_friction"], dry]
    weighed = {"constant_force": Weighed(0.8, 0.8, ["current_offset"], ["coulomb_friction"])}
    one = with_dry(ended.search, ended.found.chosen, weighed)["constant_force"]
    same = ["coulomb_friction", "current_offset"] if told else ["current_offset"]
    assert (one.equivalents, bool(one.rivals)) == (same, not told)


@pytest.mark.parametrize(
    ("one_way", "left", "told"),
    [([""], 0.1, True), ([], 0.1, False), ([""], 0.2, False)],
)
def test_a_constant_is_told_beside_dry_friction_of_logs_of_one_way(
    one_way, left, told, monkeypatch
):
    monkeypatch.setattr(dry_friction, "one_way", lambda train, heldout: one_way)
    constant, dry = all_effects()["constant_force"], all_effects()["coulomb_friction"]
    sets = machines.model([], 1.0), machines.model([constant], left), machines.model([dry], 0.1)
    ended = machines.ended(*sets)
    ended.search.candidates = [constant, all_effects()["stribeck_friction"], dry]
    weighed = {"coulomb_friction": Weighed(0.8, 0.8, [], ["stribeck_friction"])}
    one = with_dry(ended.search, ended.found.chosen, weighed)["coulomb_friction"]
    assert one.equivalents == (["constant_force"] if told else [])
    assert one.rivals == ["stribeck_friction"]
