"""An error that lives in one regime lands there, and the regimes of a kind share all of it out."""

from itertools import pairwise

import numpy as np
import pytest

from spirob.diagnosis.atlas import Regime, atlas, masks_of, worst
from spirob.identify.problem import Effort
from tests.diagnosis.stretches import SECONDS, pair, problem, stretch

BANDS = [
    f"{way}, {pace}"
    for way in ("winding in", "paying out")
    for pace in ("slow", "at middle speed", "fast")
]
PARTITIONS = [
    ["standing", *BANDS],
    ["standing", "winding in", "paying out"],
    ["low load", "middle load", "high load"],
    ["loading", "unloading", "steady load"],
    ["nearest third of the way", "middle third of the way", "furthest third of the way"],
    [f"{third} third of the trial" for third in ("first", "middle", "last")],
    [f"{part} third of lag" for part in ("least", "middle", "largest")],
    ["left motor driven", "right motor driven"],
    [p.trial for p in pair()],
]


def noise(count, seed=0):
    return np.random.default_rng(seed).standard_normal(count)


def shares(regimes):
    return {r.regime: r.share_of_error for r in regimes}


@pytest.mark.parametrize("names", PARTITIONS)
def test_the_regimes_of_a_kind_share_out_all_error_and_all_time(names):
    pieces = [
        stretch(p.trial, p.channel, pace, lag=noise(len(SECONDS), k))
        for k, (p, pace) in enumerate(zip(pair(), (1.0, 1.6, 1.0, 1.6), strict=True))
    ]
    found = {r.regime: r for r in atlas(problem(*pieces), noise(4 * len(SECONDS)))}
    assert sum(found[n].share_of_error for n in names) == pytest.approx(1.0)
    assert sum(found[n].share_of_time for n in names) == pytest.approx(1.0)


@pytest.mark.parametrize("name", ["loading", "unloading", *BANDS, "first third of the trial"])
def test_an_error_that_lives_in_one_regime_lands_there(name):
    piece = stretch()
    inside = masks_of(piece)[name]
    assert inside.any()
    found = {r.regime: r for r in atlas(problem(piece), np.where(inside, 0.02, 0.0))}
    assert found[name].share_of_error == pytest.approx(1.0)
    assert found[name].bias == pytest.approx(0.02)


def test_loading_is_where_the_load_grows_and_steady_where_it_stays():
    piece = stretch()
    rate = np.gradient(piece.effort, SECONDS)
    found, inner = masks_of(piece), slice(10, -10)
    steep = np.abs(rate) > 0.1
    assert np.array_equal(found["loading"][inner][steep[inner]], rate[inner][steep[inner]] > 0)
    flat = stretch()
    object.__setattr__(flat, "effort", np.full(len(SECONDS), -0.4))
    assert masks_of(flat)["steady load"].all()


def test_a_load_that_pulls_the_other_way_loads_where_its_size_grows():
    piece = stretch()
    mirrored = stretch()
    object.__setattr__(mirrored, "effort", -piece.effort)
    assert np.array_equal(masks_of(mirrored)["loading"], masks_of(piece)["loading"])


def test_temperatures_are_told_apart_in_bands_and_left_out_where_there_is_one():
    same = [stretch(temperature=np.full(len(SECONDS), 26.0))]
    assert "temperature" not in {r.kind for r in atlas(problem(*same), noise(len(SECONDS)))}
    warming = [stretch(temperature=24.9 + 8.0 * SECONDS / 8.0)]
    warm = {
        r.regime: r
        for r in atlas(problem(*warming), noise(len(SECONDS)))
        if r.kind == "temperature"
    }
    assert sum(r.share_of_time for r in warm.values()) == pytest.approx(1.0)
    assert warm["winding at 25 to 30 °C"].share_of_time == pytest.approx(5 / 8, abs=0.01)


def test_signals_that_were_not_recorded_make_no_regime():
    kinds = {r.kind for r in atlas(problem(stretch()), noise(len(SECONDS)))}
    assert not kinds & {"command lag", "temperature", "slack", "contact", "trial"}


def test_masks_from_elsewhere_are_counted_and_empty_ones_left_out():
    slack, never = SECONDS < 1.0, np.zeros(len(SECONDS), bool)
    more = [{"slack": {"antagonist slack": slack}, "contact": {"at the end stop": never}}]
    found = shares(atlas(problem(stretch()), np.where(slack, 1.0, 0.0), more))
    assert found["antagonist slack"] == pytest.approx(1.0)
    assert "at the end stop" not in found


def regime(name, error, time, kind):
    return Regime(name, error, time, 0.001, 0.01, kind)


def test_the_worst_regimes_are_of_different_kinds_and_none_is_nearly_everything():
    found = worst(
        [
            regime("winding in", 0.7, 0.4, "velocity"),
            regime("winding in, fast", 0.6, 0.35, "velocity"),
            regime("right motor driven", 0.7, 0.5, "motor"),
            regime("one trial", 0.5, 0.25, "trial"),
            regime("least third of lag", 0.5, 0.33, "command lag"),
            regime("steady load", 0.99, 0.85, "loading"),
            regime("low load", 0.2, 0.33, "load"),
        ],
        Effort("motor current", "A"),
    )
    assert [s.split(": ")[1].split(" (")[0] for s in found] == [
        "winding in",
        "one trial",
        "least third of lag",
    ]
    assert found[0].startswith("70% of the error in 40% of the time: ")


def test_no_regime_is_worst_of_an_error_that_is_everywhere_alike():
    even = atlas(problem(*pair()), np.full(4 * len(SECONDS), 0.01))
    assert all(r.share_of_error == pytest.approx(r.share_of_time) for r in even)
    assert all(a.share_of_error >= b.share_of_error for a, b in pairwise(even))
