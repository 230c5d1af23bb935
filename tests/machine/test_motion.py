"""Holds are left out, reversals not; one law of dry friction is enough; a delay of whole rows."""

from types import SimpleNamespace

import numpy as np
import pytest

from spirob.diagnosis.model import is_dry
from spirob.effects import all_effects
from spirob.machine.laws import related
from spirob.machine.motion import holds, late, without_holds
from spirob.machine.preparation import ready_of
from spirob.machine.recording import prepare
from spirob.machine.rig import RigFile
from tests.machine.rigs import description

LIBRARY = all_effects()


def recording(standing, seconds=6, noise=0.0):
    t = np.arange(0, seconds, 2e-3)
    q = np.sin(np.pi * np.clip(t, 0, standing))
    q += noise * np.random.default_rng(18700).normal(size=len(t))
    rig = RigFile.model_validate(description())
    return prepare("log", {"t": t, "q": q, "u": np.cos(t)}, rig)


def test_a_hold_is_left_out_and_said():
    made = recording(4.5)
    (kept,), (sentence,) = without_holds([made], 0.03)
    gone = made.pieces[0].use & ~kept.pieces[0].use
    assert made.pieces[0].seconds[gone].min() > 4.3
    assert "where the axis stands" in sentence


def test_an_axis_stands_whatever_its_sensor_adds():
    """A potentiometer's noise makes more than a hundredth of its speed in a tenth of a second."""
    made = recording(2.5, noise=6e-3)
    (kept,), (sentence,) = without_holds([made], 0.03)
    stands = made.pieces[0].use & (made.pieces[0].seconds > 2.7)
    assert kept.pieces[0].use[stands].mean() < 0.05
    assert kept.pieces[0].use[made.pieces[0].seconds < 2.3].mean() > 0.8
    assert "where the axis stands" in sentence


def test_slow_motion_in_coarse_counts_is_no_hold():
    t = np.arange(0, 20, 2e-3)
    counts = np.round(np.sin(0.6 * t) / 0.05)
    log = {"t": t, "q": 0.05 * counts, "u": np.cos(t)}
    made = prepare("log", log, RigFile.model_validate(description()))
    (piece,) = made.pieces
    slow = holds(piece.v, 0.006, made.period, piece.still)
    assert slow.mean() > holds(piece.v, 0.006, made.period).mean() + 0.05
    (kept,), _ = without_holds([made], 0.006)
    expected = piece.use & ~holds(piece.v, 0.006, made.period)
    np.testing.assert_array_equal(kept.pieces[0].use, expected)


def test_of_a_log_that_stands_two_seconds_of_motion_are_enough():
    made = recording(4.5, seconds=60)
    (kept,), (sentence,) = without_holds([made], 0.03)
    assert kept.pieces[0].seconds[kept.pieces[0].use].max() < 5.0
    assert "where the axis stands" in sentence


def test_a_reversal_is_no_hold():
    made = recording(6.0)
    assert not holds(made.pieces[0].v, 0.03, made.period).any()


def test_a_log_of_holds_is_used_as_it_is():
    made = recording(0.9)
    (kept,), (sentence,) = without_holds([made], 0.03)
    assert kept is made
    assert "stands most of the time" in sentence


def test_what_is_held_out_of_a_log_that_ends_at_rest_moves(tmp_path):
    rig = RigFile.model_validate(description())
    ready = ready_of(rig, tmp_path, [recording(4.0)], [])
    (held,) = ready.test
    speeds = np.concatenate([p.v[p.use] for p in held.pieces])
    assert len(speeds) > 500
    assert np.sqrt(np.mean(speeds**2)) > 1.0  # of π/√2
    assert not any("stands most of the time" in said for said in ready.said)


def test_dry_friction_is_known_by_its_kernel():
    dry = {name for name, effect in LIBRARY.items() if is_dry(effect)}
    assert dry == {"coulomb_friction", "stribeck_friction", "presliding_friction"}
    assert related(LIBRARY["stribeck_friction"], [LIBRARY["coulomb_friction"]])
    assert not related(LIBRARY["quadratic_drag"], [LIBRARY["coulomb_friction"]])


@pytest.mark.parametrize("rows", [0, 3, -3, 60, -60])
def test_an_effort_that_comes_rows_later_is_held_at_its_ends(rows):
    values = np.sin(np.arange(80.0))
    motion = SimpleNamespace(starts=np.array([0, 30, 80]), steps=np.array([1e-3, 1e-3]))
    parts = values[:30], values[30:]
    expected = [part[np.clip(np.arange(len(part)) - rows, 0, len(part) - 1)] for part in parts]
    np.testing.assert_allclose(late(values, rows * 1e-3, motion), np.concatenate(expected))
