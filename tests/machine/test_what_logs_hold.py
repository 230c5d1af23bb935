"""What a description leaves open, and what only one of the logs tells: sides, directions."""

from types import SimpleNamespace

import numpy as np
import pytest

from spirob.machine import axis
from spirob.machine.axis import diagnose_recordings
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.problem import Work
from spirob.machine.recordings.recording import prepare
from spirob.machine.search import models
from spirob.machine.search.models import Models
from spirob.machine.search.plausibility import AT_LOAD
from tests.machine.judging import OTHERS
from tests.machine.rigs import description

T = np.arange(0.0, 10.0, 4e-3)
OFTEN = np.arange(0.0, 10.0, 2e-3)  # a twist shows in the fourth derivative of the motion
SOFT = 0.04  # rad for 1 N·m
LOAD, ROTOR, VISCOUS, DRY = 0.05, 0.02, 0.1, 0.3


def soft_gear(seed):
    """Both ends of an elastic gear: the load swings as wanted, the motor by the twist besides.

    q_m = q_l + c·J_l·q̈_l;  u = J_l·q̈_l + J_m·q̈_m + b·q̇_m + F·tanh(q̇_m/v₀)
    """
    rng = np.random.default_rng(seed)
    w = 2 * np.pi * np.array([0.35, 1.1, 2.3]) * rng.uniform(0.9, 1.1, 3)
    angles, sizes = np.outer(OFTEN, w) + rng.uniform(0, 2 * np.pi, 3), np.array([1.2, 0.5, 0.3])
    load, acceleration = np.sin(angles) @ sizes, -np.sin(angles) @ (sizes * w**2)
    motor = load + SOFT * LOAD * acceleration
    more = sizes * (w - SOFT * LOAD * w**3)
    v, a = np.cos(angles) @ more, -np.sin(angles) @ (more * w)
    u = LOAD * acceleration + ROTOR * a + VISCOUS * v + DRY * np.tanh(v / 0.02)
    noise = rng.standard_normal((3, len(OFTEN)))
    ends = {"load": load + 2e-5 * noise[0], "motor": motor + 2e-5 * noise[1]}
    return ends, u + 5e-3 * noise[2]


@pytest.mark.parametrize(("end", "rows"), [("load", 5000), ("motor", 3000)])
def test_the_side_of_the_sensor_is_found_where_it_is_not_told(tmp_path, end, rows):
    """At the load the twist has to be told from noise, which takes the more rows."""
    rig = RigFile.model_validate(description())
    logs = []
    for seed in range(3):
        ends, u = soft_gear(2600 + seed)
        log = {"t": OFTEN, "q": ends[end], "u": u}
        logs.append(prepare(f"{seed}", {name: of[:rows] for name, of in log.items()}, rig))
    found = diagnose_recordings(rig, tmp_path, logs[:2], logs[2:], without=OTHERS)
    names = {f.name for f in found.findings}
    assert "coulomb_friction" in names
    assert (AT_LOAD in found.notes) == (end == "load")
    if end == "load":
        assert names == {"coulomb_friction", "gear_compliance"}
        numbers = next(f.numbers for f in found.findings if f.name == "gear_compliance")
        whole = SOFT * LOAD / (LOAD + ROTOR)  # for a unit of torque of all that moves
        assert numbers["compliance"]["value"] == pytest.approx(whole, rel=0.02)


def one_way(sign, seed):
    """A log that turns one way: from rest to a speed that changes, dry friction, an offset."""
    rng = np.random.default_rng(seed)
    w, phases = 2 * np.pi * rng.uniform(0.2, 0.9, 2), rng.uniform(0, 2 * np.pi, 2)
    v = sign * (6.0 + np.sin(np.outer(T, w) + phases) @ [2.0, 1.5])
    u = 0.01 * np.gradient(v, T) + 0.05 * v + 0.2 * sign + 0.05
    noise = rng.standard_normal((2, len(T)))
    q = np.cumsum(v) * (T[1] - T[0])
    return {"t": T, "q": q + 2e-5 * noise[0], "u": u + 3e-3 * noise[1]}


@pytest.mark.parametrize("ways", [(-1, 1, 1), (-1, 1, 1, 1, 1)])
def test_the_one_log_that_turns_the_other_way_is_never_left_out(tmp_path, ways):
    """Without it, friction and offset are one; more logs of the others change nothing."""
    rig = RigFile.model_validate(description())
    logs = [prepare(f"{k}", one_way(way, 2700 + k), rig) for k, way in enumerate((*ways, -1, 1))]
    found = diagnose_recordings(rig, tmp_path, logs[:-2], logs[-2:], without=OTHERS)
    named = [{f.name, *f.equivalents} for f in found.findings]
    assert len(named) == 2
    assert any("coulomb_friction" in names for names in named)
    assert any({"constant_force", "current_offset"} <= names for names in named)


def leaning(way, seed):
    """A log of one way, of an axis that drags half as much again forward as backward."""
    made = one_way(way, seed)
    dragged = 0.05 * np.gradient(made["q"], T) if way > 0 else 0.0
    return {**made, "u": made["u"] + dragged - 0.05 - 0.2 * way}


def test_what_the_held_out_log_alone_shows_is_found_with_the_ends_held_out(tmp_path):
    rig = RigFile.model_validate(description())
    logs = [prepare(f"{way}", leaning(way, 2730 + way), rig) for way in (1, -1)]
    found = diagnose_recordings(rig, tmp_path, logs[:1], logs[1:], without=OTHERS)
    assert [f.name for f in found.findings] == ["asymmetric_viscous_friction"]
    (note,) = (text for text in found.notes if "they show what these do not" in text)
    assert "30% of every log, and of its motion, was kept aside" in note


def test_a_search_that_took_long_is_not_repeated_and_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr(models, "LONG", 0)
    rig = RigFile.model_validate(description())
    logs = [prepare(f"{way}", leaning(way, 2730 + way), rig) for way in (1, -1)]
    found = diagnose_recordings(rig, tmp_path, logs[:1], logs[1:], without=OTHERS)
    assert found.verdict == "unknown"
    (note,) = (text for text in found.notes if "they show what these do not" in text)
    assert note.endswith(axis.UNTRIED)


def test_more_than_a_pair_is_looked_for_while_there_is_time():
    problem, search = SimpleNamespace(work=Work(1_000_000)), Models.__new__(Models)
    search.train, three = problem, SimpleNamespace(effects=(1, 2, 3))
    search.tried = {frozenset(): three}
    assert not search.complete(three)
    assert not search.cut
    problem.work.samples = 2 * models.LONG
    assert search.complete(three)
    assert search.cut
    assert not search.complete(SimpleNamespace(effects=(1, 2)))


def test_logs_of_one_direction_give_one_name_for_friction_and_a_force(tmp_path):
    rig = RigFile.model_validate(description())
    logs = [prepare(f"{k}", one_way(1, 2720 + k), rig) for k in range(3)]
    found = diagnose_recordings(rig, tmp_path, logs[:2], logs[2:], without=OTHERS)
    (one,) = found.findings
    assert {"coulomb_friction", "constant_force"} <= {one.name, *one.equivalents}
    assert any("one way only" in note for note in found.notes)
    assert found.document["model"]["way"] == 1


def weighted(kind, seed):
    """A lever with a weight and dry friction, moved in one of four ways; its effort follows.

    u = J·q̈ + b·q̇ + F·tanh(q̇/v₀) + W·sin q
    """
    rng = np.random.default_rng(seed)
    fast = {"tones": (0.2, 0.9), "slow": (0.05, 0.12), "quick": (1.5, 2.5), "one way": (0.2, 0.6)}
    w, phases = 2 * np.pi * rng.uniform(*fast[kind], 2), rng.uniform(0, 2 * np.pi, 2)
    sizes = np.array([0.5, 0.3])
    angles, drift = np.outer(T, w) + phases, 3.0 if kind == "one way" else 0.0
    q, v = np.sin(angles) @ sizes + drift * T, np.cos(angles) @ (sizes * w) + drift
    u = -0.03 * np.sin(angles) @ (sizes * w**2) + 0.04 * v + 0.15 * np.tanh(v / 0.01)
    noise = rng.standard_normal((2, len(T)))
    return {"t": T, "q": q + 2e-5 * noise[0], "u": u + 0.4 * np.sin(q) + 4e-3 * noise[1]}


def test_more_logs_never_make_the_answer_worse(tmp_path):
    """Nested sets of logs that differ in kind: each gives the same two names."""
    rig = RigFile.model_validate(description())
    kinds = ("tones", "one way", "slow", "quick")
    logs = [prepare(kind, weighted(kind, 2800 + k), rig) for k, kind in enumerate(kinds)]
    held = prepare("held out", weighted("tones", 2810), rig)
    for count in range(1, len(logs) + 1):
        found = diagnose_recordings(rig, tmp_path, logs[:count], [held], without=OTHERS)
        assert {f.name for f in found.findings} == {"coulomb_friction", "tip_payload"}, count


def test_a_held_out_log_of_another_sign_teaches_nothing(tmp_path):
    rig = RigFile.model_validate(description())
    made = weighted("tones", 2740), weighted("tones", 2741)
    made[1]["u"] *= -1.0
    logs = [prepare(f"{k}", columns, rig) for k, columns in enumerate(made)]
    found = diagnose_recordings(rig, tmp_path, logs[:1], logs[1:], without=OTHERS)
    assert found.verdict == "unknown"
    assert not any("they show what these do not" in text for text in found.notes)


def test_a_zero_that_moved_in_the_held_out_log_alone_is_no_other_unit(tmp_path):
    rig = RigFile.model_validate(description())
    made = [weighted("tones", 2740 + k) for k in range(3)]
    made[2]["q"] += 0.5
    logs = [prepare(f"{k}", columns, rig) for k, columns in enumerate(made)]
    found = diagnose_recordings(rig, tmp_path, logs[:2], logs[2:], without=OTHERS)
    assert {f.name for f in found.findings} == {"coulomb_friction", "tip_payload"}
    assert any("a number of their own, zero" in text for text in found.notes)
