"""A spring that the description does not fit is told, and gives no other name."""

import re
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from spirob.diagnosis.conclusion import Weighed
from spirob.diagnosis.criteria import Criteria, Worth
from spirob.diagnosis.model import Found
from spirob.effects import all_effects, find_effects
from spirob.identify.intervals import Estimate
from spirob.machine import springs
from spirob.machine.axis import diagnose_recordings
from spirob.machine.inverse import Work
from spirob.machine.judging import Judged
from spirob.machine.preparation import ready_of
from spirob.machine.recording import prepare
from spirob.machine.rig import Bounded, RigFile
from tests.machine.rigs import description

RIG = RigFile.model_validate(description())
KEPT = {"coulomb_friction", "constant_force", "current_offset", "quadratic_drag", "tip_payload"}
OTHERS = set(all_effects()) - KEPT


def log(name, tones, spring=0.0, rest=0.0, dry=0.0, cubic=0.0, size=0.2):
    t = np.arange(0, 10, 5e-3)
    w = np.array(tones)[:, None]
    q = size * np.sum(np.sin(w * t), axis=0)
    v, a = size * np.sum(w * np.cos(w * t), axis=0), -size * np.sum(w**2 * np.sin(w * t), axis=0)
    u = 0.01 * a + 0.05 * v + spring * (q - rest) + cubic * q**3 + dry * np.tanh(v / 0.02)
    u += 0.01 * np.random.default_rng(len(name)).normal(size=len(t))
    return prepare(name, {"t": t, "q": q, "u": u}, RIG)


def diagnosed(tmp_path, rig=RIG, **acts):
    logs = [log("a", (3.0, 7.1), **acts), log("bb", (2.0, 5.3), **acts)]
    test = [log("ccc", (2.6, 6.1), **acts)]
    return diagnose_recordings(rig, tmp_path, logs, test, without=OTHERS).document


def told(document):
    return [text for text in document["repairs"] if "stiffness" in text]


@pytest.mark.parametrize("rest", [0.0, 0.15])
def test_a_spring_that_is_not_described_is_told_and_fitted(tmp_path, rest):
    document = diagnosed(tmp_path, spring=1.0, rest=rest)
    assert {e["name"] for e in document["effects"]} <= {"constant_force", "current_offset"}
    (said,) = told(document)
    size, low, high = map(
        float, re.search(r"spring of ([\d.]+) \S+ \(([\d.]+) to ([\d.]+)\)", said).groups()
    )
    assert low <= 1.0 <= high  # as rounded
    assert size == pytest.approx(1.0, rel=0.05)
    assert document["numbers"]["stiffness"]["value"] == pytest.approx(1.0, rel=0.05)
    assert document["ladder"][-1]["test"]["rmse"] < 0.05 * document["effort_rms"]["test"]


def test_a_weight_held_upright_is_a_spring_of_the_other_sign(tmp_path):
    document = diagnosed(tmp_path, spring=-1.0)
    (said,) = told(document)
    assert re.search(r"a spring of -(1|0\.99\d) N·m/rad", said)
    assert "a weight held upright" in said
    assert document["numbers"]["stiffness"]["value"] == pytest.approx(-1.0, rel=0.05)


@pytest.mark.parametrize("key", ["fit", "known"])
def test_of_a_spring_that_is_described_nothing_is_told(tmp_path, key):
    spring = {"nominal": 1.0, "low": 0.0, "high": 10.0} if key == "fit" else 0.5
    given = description()
    given[key] = {**given.get(key, {}), "stiffness": spring}
    assert told(diagnosed(tmp_path, RigFile.model_validate(given), spring=1.0)) == []


def test_no_spring_is_told_where_friction_is_missing(tmp_path):
    document = diagnosed(tmp_path, dry=0.2)
    assert [e["name"] for e in document["effects"]] == ["coulomb_friction"]
    assert told(document) == []


@dataclass(frozen=True)
class Logs:
    """A rig's logs, as far as they are looked at here."""

    rig: RigFile = RIG
    work: Work | None = None
    bounds: Bounded | None = None

    def progress(self, text):
        """Nobody reads it."""


@pytest.mark.parametrize(
    ("probability", "left", "fitted"),
    [(0.7, 0.05, True), (0.7, 0.3, False), (0.7, None, False), (0.2, 0.05, True)],
)
@pytest.mark.parametrize("kind", ["unknown", "named"])
def test_a_name_falls_where_a_spring_in_its_place_leaves_half(
    monkeypatch, probability, left, fitted, kind
):
    """left  squared error that a spring leaves held out in the name's place, which leaves 0.4"""
    ripple = find_effects(["torque_ripple"])[0]
    bounds = Bounded(nominal=1.0, low=0.0, high=9.0)
    estimates = {"rig.stiffness": Estimate(2.0, 1.9, 2.1, "N·m/rad", False)}

    def model(square):
        fit = SimpleNamespace(estimates=estimates, changes={})
        known = {"effects": (ripple,), "fit": fit, "errors": np.full(16, square)}
        return SimpleNamespace(**known, mean_square=square, heldout_square=square)

    sprung = None if left is None else (None, model(left))
    beside = SimpleNamespace(fitted=lambda effects, _: None if effects else sprung, bounds=bounds)
    monkeypatch.setattr(springs._Beside, "of", lambda ready: beside)
    monkeypatch.setattr(springs, "effort_rms", lambda problem: 1.0)
    ready = Logs()
    monkeypatch.setattr(springs, "_sprung", lambda ready, bounds: replace(ready, bounds=bounds))
    models = SimpleNamespace(promised=0.5, heldout=None)
    search = SimpleNamespace(models=models, worth=Worth(Criteria(), 0.1))
    weighed = {"torque_ripple": Weighed(probability, probability)}
    verdict = SimpleNamespace(doubts=(), weighed=weighed)
    done = SimpleNamespace(ready=ready, search=search, is_long=False)
    judged = Judged(done, Found([model(0.4)]), verdict, None)
    asked = []
    explained = model(0.05 if kind == "unknown" else 0.6)  # more than without the spring
    kinds = SimpleNamespace(kind=kind)
    again = SimpleNamespace(noted=lambda said: said, explained=explained, verdict=kinds)
    found = springs.with_spring(judged, lambda told: asked.append(told.bounds) or again)
    assert asked == [bounds] * fitted
    if not fitted:
        assert found is judged
        return
    likely = r"Not torque ripple.*: a spring of 2 N·m/rad .* leave 22\.4% .* and it 63\.2%"
    unlikely = r"With a spring of 2 N·m/rad .*, 22\.4% of the effort .* without it 63\.2%"
    assert re.match(likely if probability > 0.5 else unlikely, found)
    assert found.endswith(springs.FITTED)


@pytest.mark.parametrize("size", [0.2, 1.0])
def test_a_spring_that_grows_with_the_way_is_no_straight_one_and_no_weight(tmp_path, size):
    """A straight one takes most of it, and over a large angle a weight beside it the rest."""
    document = diagnosed(tmp_path, spring=0.3, cubic=0.8 / size**2, size=size)
    assert document["verdict"] == "unknown"
    assert document["effects"] == []
    assert "cubic" in document["composed"]["terms"]


def test_a_weight_is_no_candidate_beside_a_spring_that_is_not_described(tmp_path):
    ready = ready_of(RIG, tmp_path, [log("a", (3.0, 7.1), size=1.0)], [])
    assert "tip_payload" in {e.name() for e in ready.possible}
    bounds = Bounded(nominal=1.0, low=0.0, high=9.0)
    told = springs._sprung(ready, bounds)
    assert told.rig.fit["stiffness"] == bounds
    assert {e.name() for e in told.possible} == {e.name() for e in ready.possible} - {"tip_payload"}
    assert "tip_payload" in told.excluded
