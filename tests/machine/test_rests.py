"""Rests are left out, however short; reversals not; and what lies in a rest weighs nothing."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import spirob
from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.recording import prepare
from spirob.machine.recordings.rests import standing, without_rests
from spirob.machine.search.preparation import ready_of
from tests.machine.rigs import description

RIG = RigFile.model_validate(description())
DRY, INERTIA, VISCOUS = 0.3, 0.01, 0.05
STEP = 2e-4  # s


def recording(standing, seconds=6, noise=0.0):
    t = np.arange(0, seconds, 2e-3)
    q = np.sin(np.pi * np.clip(t, 0, standing))
    q += noise * np.random.default_rng(18700).normal(size=len(t))
    return prepare("log", {"t": t, "q": q, "u": np.cos(t)}, RIG)


def test_a_hold_is_left_out_and_said():
    made = recording(4.5)
    (kept,), (sentence,) = without_rests([made], 0.03)
    gone = made.pieces[0].use & ~kept.pieces[0].use
    assert made.pieces[0].seconds[gone].min() > 4.3
    assert "where the axis stands" in sentence


def test_an_axis_stands_whatever_its_sensor_adds():
    """A potentiometer's noise makes more than a hundredth of its speed in a tenth of a second."""
    made = recording(2.5, noise=6e-3)
    (kept,), (sentence,) = without_rests([made], 0.03)
    stands = made.pieces[0].use & (made.pieces[0].seconds > 2.7)
    assert kept.pieces[0].use[stands].mean() < 0.05
    assert kept.pieces[0].use[made.pieces[0].seconds < 2.3].mean() > 0.8
    assert "where the axis stands" in sentence


def test_slow_motion_in_coarse_counts_is_no_rest():
    t = np.arange(0, 20, 2e-3)
    counts = np.round(np.sin(0.6 * t) / 0.05)
    made = prepare("log", {"t": t, "q": 0.05 * counts, "u": np.cos(t)}, RIG)
    assert not np.any(standing(made, 0.006))


def test_of_a_log_that_stands_two_seconds_of_motion_are_enough():
    made = recording(4.5, seconds=60)
    (kept,), (sentence,) = without_rests([made], 0.03)
    assert kept.pieces[0].seconds[kept.pieces[0].use].max() < 5.0
    assert "where the axis stands" in sentence


def test_a_reversal_is_no_rest():
    assert not np.any(standing(recording(6.0), 0.03))


def test_a_log_of_holds_is_used_as_it_is():
    made = recording(0.9)
    (kept,), (sentence,) = without_rests([made], 0.03)
    assert kept is made
    assert "stands most of the time" in sentence


def test_what_is_held_out_of_a_log_that_ends_at_rest_moves(tmp_path):
    ready = ready_of(RIG, tmp_path, [recording(4.0)], [])
    (held,) = ready.test
    speeds = np.concatenate([p.v[p.use] for p in held.pieces])
    assert len(speeds) > 500
    assert np.sqrt(np.mean(speeds**2)) > 1.0  # of π/√2
    assert not any("stands most of the time" in said for said in ready.said)


def sticking(tones, size, seed):
    """Ten seconds under a torque of these tones [Hz]: an axis sticks until it exceeds `DRY`."""
    t, rng = np.arange(0.0, 10.0, STEP), np.random.default_rng(seed)
    u = size * sum(np.sin(2 * np.pi * f * t + rng.uniform(0, 2 * np.pi)) for f in tones)
    q, v, path, rests = 0.0, 0.0, [], []
    for torque in u:
        stuck = v == 0.0 and abs(torque) <= DRY
        if not stuck:
            way = np.sign(v) or np.sign(torque)
            after = v + STEP * (torque - VISCOUS * v - DRY * way) / INERTIA
            v = 0.0 if after * v < 0.0 else after
        q += STEP * v
        path.append(q)
        rests.append(stuck)
    turn = 2 * np.pi / 16384
    counted, noisy = np.round(np.array(path) / turn) * turn, u + 3e-3 * rng.normal(size=len(u))
    table = pd.DataFrame({"t": t, "q": counted, "u": noisy})[::10]
    return table, np.array(rests)[::10]


def test_where_an_axis_sticks_for_a_moment_it_stands():
    table, stuck = sticking((1.0, 2.3), 0.5, 5)
    made = prepare("log", {name: table[name].to_numpy() for name in table}, RIG)
    (stands,) = standing(made, 0.03)
    assert 0.1 < stuck.mean() < 0.5
    assert stands[stuck].mean() > 0.9
    assert stands[~stuck].mean() < 0.25  # beside a rest, where the filter brings it


def test_what_lies_in_a_rest_weighs_nothing():
    made = recording(2.5)
    (still,) = standing(made, 0.03)
    piece = replace(made.pieces[0], stands=still)
    last, kept = made.last_of(piece), made.moving(piece) > 0.5
    values = np.cos(np.arange(len(still)))
    np.testing.assert_allclose(last(np.full_like(values, 3.0))[kept], 3.0)
    np.testing.assert_array_equal(last(values + 1e3 * still), last(values))
    np.testing.assert_array_equal(made.last_of(made.pieces[0])(values), made.last(values))


@pytest.mark.parametrize("tones", [(1.0,), (1.0, 2.3)])
def test_an_axis_that_sticks_while_its_effort_turns_has_dry_friction(tones):
    """Rows at which it sticks are a quarter to a third of the logs, in rests of 0.1 to 0.25 s."""
    logs = [sticking(tones, 0.5, seed)[0] for seed in (1, 2, 3)]
    found = spirob.diagnose(description(), train=logs[:2], test=logs[2:])
    (name,) = found.findings
    assert "coulomb_friction" in (name.name, *name.equivalents, *name.rivals)
    level = name.numbers.get("coulomb_torque") or name.numbers["sliding_torque"]
    assert level["value"] == pytest.approx(DRY, rel=0.05)
    errors = found.ladder["test_rmse"]
    assert errors.iloc[-1] < 0.1 * errors.iloc[0]


def test_a_creeping_axis_does_not_rest():
    """Friction by speed tells its effort, and how it turns round: a tenth of the motion is slow."""
    t, logs = np.arange(0.0, 10.0, 2e-3), []
    for k in range(3):
        u = 0.6 * np.sin(2 * np.pi * (0.4 + 0.2 * k) * t)
        v = 0.02 * np.arctanh(np.clip(u / 0.35, -0.9999, 0.9999))
        v += np.sign(u) * np.maximum(np.abs(u) - 0.35, 0.0) / VISCOUS
        q = np.cumsum(v) * 2e-3 + 1e-5 * np.random.default_rng(k).normal(size=len(t))
        logs.append(prepare(f"log{k}", {"t": t, "q": q, "u": u}, RIG))
    assert np.mean(standing(logs[0], 0.05)) > 0.1
    assert without_rests(logs, 0.05) == (logs, [])
    stuck = [sticking((1.0,), 0.5, seed)[0] for seed in (1, 2)]
    rested = [prepare("log", {n: one[n].to_numpy() for n in one}, RIG) for one in stuck]
    _, said = without_rests(rested, 0.03)
    assert len(said) == 2


def test_an_axis_that_waits_for_a_step_does_not_creep():
    """A filter carries the step of the effort and of the speed into the wait before it alike."""
    t = np.arange(0.0, 6.0, 0.02)
    on = np.maximum(t - 2.0, 0.0)
    v = 10.0 * (1.0 - np.exp(-on / 0.1))
    columns = {"t": t, "q": np.cumsum(v) * 0.02, "u": 9.0 * (on > 0.0)}
    made = prepare("log", columns, RIG)
    (kept,), (said,) = without_rests([made], 0.1)
    assert "where the axis stands" in said
    assert kept.pieces[0].seconds[kept.pieces[0].use].min() > 1.8


def test_friction_that_turns_round_softly_creeps_at_each_reversal():
    """A controller draws the axis through each of them while its friction turns round."""
    q = v = 0.0
    rows, angular = [], 2 * np.pi * np.array([0.3, 0.7])
    for k in range(int(10.0 / STEP)):
        t = k * STEP
        if k % 10 == 0:
            goal, rate = (
                0.4 * np.sin(angular * t).sum(),
                0.4 * (angular * np.cos(angular * t)).sum(),
            )
            u = 20.0 * (goal - q) + 1.5 * (rate - v)
            rows.append((t, q, u))
        v += STEP * (u - VISCOUS * v - DRY * math.tanh(v / 0.01)) / (2.0 * INERTIA)
        q += STEP * v
    noise = np.random.default_rng(1).normal(0.0, (0.0, 1e-4, 5e-3), (len(rows), 3))
    made = prepare("log", dict(zip("tqu", (np.array(rows) + noise).T, strict=True)), RIG)
    assert np.mean(standing(made, 0.03)) > 0.1
    assert without_rests([made], 0.03) == ([made], [])
