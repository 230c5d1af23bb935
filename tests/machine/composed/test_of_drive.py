"""What a drive loses of its torque is composed of its effort, and never explains effort by it."""

from types import SimpleNamespace

import numpy as np
import pytest

from spirob.campaign.case import Case
from spirob.campaign.running import result
from spirob.effects import load_file
from spirob.machine.axis import diagnose_recordings
from spirob.machine.composed import composing
from spirob.machine.composed.composing import _drives
from spirob.machine.composed.draft import Drafts
from spirob.machine.composed.grammar import losses
from spirob.machine.composed.ground import Side
from spirob.machine.composed.track import Ranges, Track
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import Sizes
from spirob.machine.recordings.recording import prepare
from tests.machine.rigs import description

STEP, SAMPLES, FOLDS = 0.01, 1200, 4
BAND, RATE = 0.15, 200.0


def side(effort, residual):
    """Trials in which the measured effort is one thing, and what is left another."""
    t = STEP * np.arange(SAMPLES)
    place = 1.2 * np.sin(2.1 * t) + 0.3 * np.sin(5.3 * t)
    signals = {"place": place, "speed": np.gradient(place, STEP), "time": t, "load": effort}
    track = Track({**signals, "current": effort}, np.array([0, SAMPLES]), np.array([STEP]))
    slopes = np.zeros((SAMPLES, 1))
    return Side(track, residual, slopes, lambda torque: -torque, lambda values: values)


def drafts(effort, residual):
    one = side(effort, residual)
    strong = float(np.abs(effort).max())
    ranges = Ranges(0.0, 1.5, 6.0, strong, STEP * SAMPLES, 0.06, 0.0, strong=strong)
    ground = SimpleNamespace(
        train=one,
        heldout=one,
        ranges=ranges,
        folds=np.repeat(np.arange(FOLDS), SAMPLES // FOLDS),
        low=np.array([-1.0]),
        high=np.array([1.0]),
        edges=np.array([0, SAMPLES]),
        block=50,
    )
    return Drafts(ground)


def grammar(made):
    own = made.ground.train
    return losses(made.ranges, own.residual, own.track.signals, placed=True)


def test_a_residual_that_is_the_effort_itself_is_left_as_it_is():
    effort = np.random.default_rng(0).normal(size=SAMPLES)
    made = drafts(effort, -effort)
    found = grammar(made)
    assert len(found) > 20
    assert all(term.drives for term in found)
    for term in found:
        columns = made.columns(term)
        size = np.linalg.norm(columns) * np.linalg.norm(effort)
        assert np.all(np.abs(columns.T @ effort) <= 1e-9 * (1.0 + size))
        # no fold is foretold better by it than by nothing
        assert made.error((), term) > 0.95 * np.mean(effort**2)


@pytest.mark.parametrize("kind", ["driving", "dead band", "settling"])
def test_a_share_that_is_lost_of_a_known_weight_is_told(kind):
    """m = e(1 - A·φ), m known: with c·e in proportion to φ·e the factor is A/(1 - c·A)."""
    effort, lost = np.random.default_rng(1).normal(size=SAMPLES), 0.3
    bare = drafts(effort, np.zeros(SAMPLES))
    term = next(t for t in grammar(bare) if kind in t.kinds[-1])
    part = term.along(bare.ground.train.track, bare.ranges)[0] * bare.ranges.strong
    share = (part @ effort) / (effort @ effort)
    factor = drafts(effort, -lost * part).made((term,)).factors[0][0] / bare.ranges.strong
    assert factor == pytest.approx(lost / (1.0 - lost * share), rel=1e-6)


def test_where_no_drive_makes_the_effort_none_loses_any():
    made = drafts(np.ones(SAMPLES), np.ones(SAMPLES))
    signals = {n: v for n, v in made.ground.train.track.signals.items() if n != "current"}
    assert losses(made.ranges, np.ones(SAMPLES), signals, placed=True) == []


@pytest.mark.parametrize(("origin", "made"), [("measured", True), ("sensor", False)])
def test_a_sensor_behind_the_drive_tells_nothing_of_what_it_loses(origin, made):
    effort = {"column": "u", "unit": "N·m", "kind": "torque", "origin": origin}
    rig = RigFile.model_validate(description(effort=effort))
    sizes = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")
    problem = InverseProblem(rig, None, [prepare("log", log(1), rig)], [], sizes, 0.02)
    track = Track.of(problem, {"rig.inertia": 0.05, "rig.viscous": 0.1})
    assert ("current" in track.signals) is made


@pytest.mark.parametrize(
    ("shares", "may"),
    [
        ([0.999], False),  # beside a scale a thousand times as large it fits any effort
        ([0.5], True),
        ([0.0], True),
        ([-0.5, 0.7], True),
        ([79.0, -73.0, -6.0], False),  # cancel one another
        ([1.4, -0.7], False),
    ],
)
def test_a_law_takes_no_more_than_all_of_a_drives_torque(shares, may):
    effort = np.random.default_rng(2).normal(size=SAMPLES)
    sizes = {f"law.amplitude_{k}": share for k, share in enumerate(shares, 1)}
    problem = SimpleNamespace(
        read=lambda changes: {"motor.current": effort},
        passed=lambda effect, changes: np.full(SAMPLES, 1.0 - sum(changes.values())),
    )
    fitted = SimpleNamespace(
        models=SimpleNamespace(train=problem),
        model=SimpleNamespace(fit=SimpleNamespace(changes=sizes)),
        law=SimpleNamespace(terms=len(shares)),
        name="law",
        effect=None,
    )
    assert _drives(fitted) == may


def log(seed):
    """An axis whose drive does nothing with its first `BAND` amperes."""
    rng, t = np.random.default_rng(seed), np.arange(0, 12, 1 / RATE)
    q = 0.8 * np.sin((1.1 + 0.2 * seed) * t) + 0.3 * np.sin((4.1 + 0.3 * seed) * t + seed)
    v, a = np.gradient(q, t), np.gradient(np.gradient(q, t), t)
    wanted = 0.05 * a + 0.1 * v
    effort = wanted + BAND * np.tanh(wanted / 1e-3) + 0.003 * rng.normal(size=len(t))
    return {"t": t, "q": q, "u": effort}


@pytest.fixture(scope="module")
def dead_band(tmp_path_factory):
    rig = RigFile.model_validate(description(criteria={"most": 2}))
    read = [prepare(f"log{k}", log(k), rig) for k in (1, 2, 3)]
    lacking = {"driver_dead_band", "coulomb_friction", "stribeck_friction", "presliding_friction"}
    folder = tmp_path_factory.mktemp("rig")
    found = diagnose_recordings(rig, folder, read[:-1], read[-1:], without=lacking)
    return rig, read, found, folder


def test_a_dead_band_that_no_name_tells_is_composed(dead_band):
    found = dead_band[2]
    law = found.document["composed"]
    assert found.document["verdict"] == "unknown"
    assert law["terms"] == ["dead band"]
    assert law["shape"].startswith("loss of the drive's torque")
    numbers, strong = law["numbers"], law["range"]["current"][1]
    lost = numbers["amplitude_1"]["value"] * numbers["dead_band_1"]["value"] * strong
    assert lost == pytest.approx(BAND, rel=0.05)  # beyond the band, whatever is in it
    assert 0.1 < law["nearest"]["share"] <= 1.0  # held against what is left without the law
    assert law["rmse"]["test"] < 0.1 * found.document["ladder"][0]["test"]["rmse"]


def test_a_model_that_holds_the_law_misses_nothing(dead_band, tmp_path):
    rig, read, found, folder = dead_band
    path = tmp_path / "law.py"
    path.write_text(found.law.text, encoding="utf-8")
    (law,) = load_file(path).values()
    assert law.port == "motor.drive_torque"
    again = diagnose_recordings(rig, folder, read[:-1], read[-1:], own=[law])
    assert again.document["verdict"] == "nothing_missing"


def test_where_a_law_on_the_drive_does_not_stand_one_beside_it_is_asked():
    """Friction by a power of the speed, of 20 rows a second: a drive that loses it swallows it."""
    found = result(Case("two_mass", "power_friction", 52201))
    assert found["composed"]["terms"] == ["power"]
    assert found["heldout"]["law"] < 1.3 * found["heldout"]["true"]


@pytest.mark.parametrize(("drive", "foretold", "stands"), [(1, 0.1, 1), (1, 2.0, 0), (0, 2.0, 1)])
def test_a_law_on_the_drive_has_to_foretell_the_effort(monkeypatch, drive, foretold, stands):
    def left(changes):
        return np.full(4, changes["left"])

    bare, made = (SimpleNamespace(fit=SimpleNamespace(changes={"left": x})) for x in (1, foretold))
    problems = SimpleNamespace(train=SimpleNamespace(foretold=left), heldout=None)
    problems.heldout = problems.train
    one = SimpleNamespace(law=SimpleNamespace(of_drive=drive), models=problems, model=made)
    worth = SimpleNamespace(matters=lambda *two: True, denied=lambda *two: False)
    monkeypatch.setattr(composing, "_drives", lambda one: True)
    assert composing._stands(SimpleNamespace(worth=worth), (bare,), one) == bool(stands)
