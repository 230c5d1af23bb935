"""Responses of all models stand at the same samples as the overlay's."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from pipeline import overlay as module
from pipeline.overlay import candidates, laws, overlay, switches
from spirob.diagnosis.criteria import Settings
from spirob.diagnosis.model import Found, Offer
from spirob.identify.residual import Filter

SAMPLES = 3000


class Machine:
    """In place of a residual: answers with its number `level` in every signal."""

    def __init__(self, name):
        signals = {c: np.zeros((SAMPLES, 2)) for c in ("current", "displacement", "velocity")}
        seconds = np.arange(SAMPLES) * 1e-3
        self.trials = [SimpleNamespace(name=name, seconds=seconds, **signals)]
        self.filter = Filter(every=10)

    def __call__(self, changes):
        return np.full(5, changes["level"])

    def respond(self, changes, index):
        whole = np.full((SAMPLES, 2), changes.get("level", 0.0))
        return SimpleNamespace(current=whole, displacement=2 * whole, velocity=3 * whole)


class Named:
    """In place of an effect."""

    def __init__(self, name):
        self.name = lambda: name


CREEP, COGGING, SAG = Named("creep"), Named("cogging"), Named("sag")


def model(level, *effects, square=1.0):
    fit = SimpleNamespace(changes={"level": level}, residual=np.full(5, level))
    names = frozenset(e.name() for e in effects)
    return SimpleNamespace(effects=effects, names=names, fit=fit, mean_square=square)


def search(machines, fitted=((CREEP, 0.5), (COGGING, 0.25)), screened=((SAG, 0.1, 0.7),), pairs=()):
    """What was fitted, the best first, and what it found: the first with another number.

    screened  with the mean square that it promises, of 1 beside the numbers alone
    """
    alone = [model(level, e, square=0.1 * (k + 1)) for k, (e, level) in enumerate(fitted)]
    tried = [model(0.0), *reversed(alone), *(model(9.0, *two, square=0.0) for two in pairs)]
    offers = [Offer(e, {"level": level}, error) for e, level, error in screened]
    offers += [Offer(e, {}, 0.5) for e, _ in fitted]
    models = SimpleNamespace(
        residuals=machines,
        train=machines["train"],
        settings=Settings(),
        tried={m.names: m for m in tried},
    )
    return models, Found([tried[0], model(0.7, CREEP)], offers)


@pytest.fixture
def machines(monkeypatch):
    def summed(problem, base, chosen, scale):
        return {"level": sum(one.changes["level"] for one in chosen)}

    monkeypatch.setattr(module, "together", summed)
    monkeypatch.setattr("spirob.diagnosis.screen.amplitudes", lambda effect, problem: ["level"])
    return {"train": Machine("none"), "validate": Machine("one"), "heldout": Machine("two")}


def test_every_combination_has_every_sample_of_the_overlay(tmp_path, machines):
    overlay(tmp_path, machines, {"level": 0.0}, {"level": 1.0})
    switches(tmp_path, *search(machines))
    drawn = pd.read_parquet(tmp_path / "overlay.parquet")
    found = pd.read_parquet(tmp_path / "combinations.parquet")
    expected = {
        "creep": ("refitted", 0.5),
        "cogging": ("refitted", 0.25),
        "sag": ("screened", 0.1),
        "creep + cogging": ("replayed", 0.75),
        "creep + sag": ("replayed", 0.6),
        "cogging + sag": ("replayed", 0.35),
        "creep + cogging + sag": ("replayed", 0.85),
    }
    assert list(found["effects"].unique()) == list(expected)
    for name, (how, level) in expected.items():
        rows = found[found["effects"] == name].reset_index(drop=True)
        keys = ["trial", "motor"]
        pd.testing.assert_frame_equal(rows[keys].astype(str), drawn[keys].astype(str))
        assert np.array_equal(rows["time"], drawn["time"])
        assert set(rows["how"]) == {how}
        assert np.allclose(rows["current"], level)
        assert np.allclose(rows["displacement"], 2 * level)
        assert np.allclose(rows["velocity"], 3 * level)


def test_what_made_nothing_better_in_the_screening_is_not_offered(machines):
    alone = candidates(*search(machines, screened=((SAG, 0.1, 1.01),)))
    assert [one.effect for one in alone] == [CREEP, COGGING]


def test_pairs_that_were_fitted_jointly_are_made_of_their_parts(machines):
    tried = search(machines, pairs=[(CREEP, COGGING)])
    assert [one.effect for one in candidates(*tried)] == [CREEP, COGGING, SAG]


def test_what_another_search_fitted_is_not_offered(machines):
    """Of the same models, among more candidates."""
    models, found = search(machines)
    models.tried[frozenset({"gone"})] = model(3.0, Named("gone"), square=0.0)
    assert [one.effect for one in candidates(models, found)] == [CREEP, COGGING, SAG]


def test_no_more_are_offered_than_a_page_can_combine(machines):
    many = [(Named(f"e{k}"), 0.1) for k in range(module.MOST + 2)]
    assert len(candidates(*search(machines, fitted=many))) == module.MOST


def test_without_candidates_there_is_no_file(tmp_path, machines):
    empty = search(machines, fitted=(), screened=())
    switches(tmp_path, *empty)
    laws(tmp_path, *empty, named=False)
    assert not list(tmp_path.iterdir())


def test_a_law_is_the_named_model_with_and_without_the_effect(tmp_path, machines):
    laws(tmp_path, *search(machines), named=True)
    rows = pd.read_parquet(tmp_path / "laws.parquet")
    assert set(rows["effect"]) == {"creep"}
    assert np.allclose(rows["with_current"], 0.7)
    assert np.allclose(rows["without_current"], 0.0)


def test_where_none_is_named_the_leading_candidates_show_theirs(tmp_path, machines):
    laws(tmp_path, *search(machines), named=False)
    rows = pd.read_parquet(tmp_path / "laws.parquet")
    assert list(rows["effect"].unique()) == ["creep", "cogging"]
    assert np.allclose(rows.groupby("effect")["with_current"].first(), [0.25, 0.5])
