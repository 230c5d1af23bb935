"""A spring that the description does not fit is told, and gives no other name."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spirob.diagnosis.criteria import Criteria, Worth
from spirob.diagnosis.model import Found
from spirob.diagnosis.verdict import Verdict, Weighed
from spirob.effects import find_effects
from spirob.identify.intervals import Estimate
from spirob.machine import springs
from spirob.machine.axis import diagnose_recordings
from spirob.machine.judging import Judged
from spirob.machine.recording import prepare
from spirob.machine.rig import RigFile
from tests.machine.rigs import description

RIG = RigFile.model_validate(description())


def log(name, tones, spring=0.0, rest=0.0, dry=0.0):
    t = np.arange(0, 10, 5e-3)
    w = np.array(tones)[:, None]
    q = 0.2 * np.sum(np.sin(w * t), axis=0)
    v, a = 0.2 * np.sum(w * np.cos(w * t), axis=0), -0.2 * np.sum(w**2 * np.sin(w * t), axis=0)
    u = 0.01 * a + 0.05 * v + spring * (q - rest) + dry * np.tanh(v / 0.02)
    u += 0.01 * np.random.default_rng(len(name)).normal(size=len(t))
    return prepare(name, {"t": t, "q": q, "u": u}, RIG)


def diagnosed(tmp_path, rig=RIG, **acts):
    logs = [log("a", (3.0, 7.1), **acts), log("bb", (2.0, 5.3), **acts)]
    return diagnose_recordings(rig, tmp_path, logs, [log("ccc", (2.6, 6.1), **acts)]).document


def told(document):
    return [text for text in document["repairs"] if "stiffness" in text]


@pytest.mark.parametrize("rest", [0.0, 0.15])
def test_a_spring_that_is_not_fitted_is_told(tmp_path, rest):
    document = diagnosed(tmp_path, spring=1.0, rest=rest)
    assert document["effects"] == []
    (said,) = told(document)
    size, low, high = map(
        float, re.search(r"of ([\d.]+) \S+ \(([\d.]+) to ([\d.]+)\)", said).groups()
    )
    assert low <= 1.0 <= high  # as rounded
    assert size == pytest.approx(1.0, rel=0.05)
    after, before = map(float, re.findall(r"([\d.]+)%", said))
    assert after < 5.0
    assert before > 60.0


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


@pytest.mark.parametrize(
    ("probability", "left", "doubted"),
    [(0.7, 0.05, True), (0.7, 0.3, False), (0.7, None, False), (0.2, 0.05, False)],
)
def test_a_name_is_doubted_where_a_spring_in_its_place_leaves_half(
    monkeypatch, probability, left, doubted
):
    """left  squared error that a spring leaves held out in the name's place, which leaves 0.4"""
    ripple = find_effects(["torque_ripple"])[0]
    chosen = SimpleNamespace(effects=(ripple,), heldout_square=0.4, mean_square=0.4)
    fit = SimpleNamespace(estimates={"rig.stiffness": Estimate(2.0, 1.9, 2.1, "N·m/rad", False)})
    sprung = None if left is None else (chosen, SimpleNamespace(heldout_square=left, fit=fit))
    beside = SimpleNamespace(fitted=lambda effects, _: None if effects else sprung)
    monkeypatch.setattr(springs._Beside, "of", lambda ready: beside)
    monkeypatch.setattr(springs, "effort_rms", lambda problem: 1.0)
    unsaid = Verdict("unknown", {}, "data and model", "", "")
    judge = lambda ended, weighed, doubts: replace(unsaid, doubts=doubts)  # noqa: E731
    monkeypatch.setattr(springs, "judge", judge)
    models = SimpleNamespace(promised=0.5, heldout=None, left=lambda model: None)
    search = SimpleNamespace(models=models, worth=Worth(Criteria(), 0.1))
    weighed = {"torque_ripple": Weighed(probability, probability)}
    verdict = SimpleNamespace(doubts=(), weighed=weighed)
    done = SimpleNamespace(ready=SimpleNamespace(rig=RIG), search=search)
    judged = Judged(done, Found([chosen]), verdict, None, law="one")
    found = springs.with_spring(judged)
    if not doubted:
        assert found is judged
        return
    assert found.law is None
    (said,) = found.verdict.doubts
    assert re.match(r"Not torque ripple.*: a spring .* leave 22\.4% .* and it 63\.2%", said)
    assert "the logs show a spring of 2 N·m/rad (1.9 to 2.1)" in found.verdict.sentence
    assert "stiffness" in found.verdict.next_experiment
