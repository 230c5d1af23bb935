"""Logs of a single-turn encoder count their turns alike where the effort tells."""

from pathlib import Path

import numpy as np
import pytest

from spirob.effects import all_effects
from spirob.machine.axis import diagnose_recordings
from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.recording import prepare
from spirob.machine.search.differing import MOST, Log, _columns, turns
from tests.machine.rigs import description

TURN = 2 * np.pi
OTHERS = frozenset(all_effects()) - {"quadratic_drag"}  # turns are counted before any is asked


def log(ends, force, seed=0, rows=2000):
    """A log that sweeps between two ends, what a force leaves of the effort there."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, 12 * np.pi, rows)
    low, high = ends
    q = 0.5 * (low + high) + 0.5 * (high - low) * np.sin(t + 0.8 * np.sin(2.3 * t))
    v = np.gradient(q, t)
    residual = force(q, v) + 0.01 * rng.standard_normal(rows)
    return Log(q, v / 4.0, np.tanh(v / 0.01), residual)


def spring(q, v):
    return 0.004 * q**3


def spot(q, v):
    return np.sign(v) * np.exp(-((q - 1.0) ** 2) / 0.1)


def thick(q, v):
    return 0.05 * v * q**2


@pytest.mark.parametrize("force", [spring, spot, thick])
@pytest.mark.parametrize("k", [-3, -1, 0, 2])
def test_a_log_is_counted_from_where_the_place_tells_the_same(force, k):
    whole, other = log((-9.0, 9.0), force), log((-5.0, 6.0), force, 1)
    found = turns([("whole", whole), ("other", other.moved(-k * TURN))], TURN)
    assert found == {"whole": 0, "other": k}


@pytest.mark.parametrize(
    "force", [lambda q, v: 0.0 * q, lambda q, v: 0.3 * v, lambda q, v: np.cos(q)]
)
def test_nothing_is_counted_where_the_turn_does_not_show(force):
    logs = [("a", log((-9.0, 9.0), force)), ("b", log((-2.0, 2.0), force, 1).moved(TURN))]
    assert turns(logs, TURN) == {"a": 0, "b": 0}


@pytest.mark.parametrize(
    "force", [lambda q, v: 0.3 * np.sign(v), lambda q, v: 0.3 * v, lambda q, v: np.cos(q)]
)
@pytest.mark.parametrize("far", [6.0, 14.0])
def test_what_comes_round_in_every_turn_tells_of_none(force, far):
    """It would where the other log ends within the known ones: beyond them nothing is told."""
    logs = [("a", log((-9.0, 9.0), force)), ("b", log((-9.0 + far, 8.0 + far), force, 1))]
    assert turns(logs, TURN) == {"a": 0, "b": 0}


def test_a_log_that_was_never_near_the_others_stays():
    far = log((-3.0, 3.0), spring, 1).moved((MOST + 5) * TURN)
    assert turns([("a", log((-9.0, 9.0), spring)), ("b", far)], TURN) == {"a": 0, "b": 0}


def recorded(name, ends, rig, wrapped, seed):
    """A log of an axis with a hardening spring, as its single-turn encoder tells it."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 8.0, 0.01)
    low, high = ends
    phase = 2 * np.pi * 0.4 * t + seed
    q = 0.5 * (low + high) + 0.5 * (high - low) * np.sin(phase)
    v = 0.5 * (high - low) * 2 * np.pi * 0.4 * np.cos(phase)
    a = -((2 * np.pi * 0.4) ** 2) * (q - 0.5 * (low + high))
    u = 0.02 * a + 0.05 * v + 0.004 * q**3 + 0.002 * rng.standard_normal(len(t))
    read = np.mod(q, TURN) if wrapped else q
    return prepare(name, {"t": t, "q": read, "u": u}, rig)


def test_a_wrapped_machine_leaves_what_it_leaves_unwrapped():
    rig = RigFile.model_validate(description())
    ends = [(-8.0, 8.0), (-6.0, 7.5), (-7.0, 6.0)]
    left = []
    for wrapped in (False, True):
        logs = [recorded(f"log_{k}", e, rig, wrapped, k) for k, e in enumerate(ends)]
        found = diagnose_recordings(rig, Path(), logs[:2], logs[2:], without=OTHERS)
        left.append(found.document["composed"]["rmse"]["test"])
        said = [s for s in found.document["repairs"] if "counted by the effort" in s]
        assert bool(said) is wrapped
    assert left[1] < 1.2 * left[0]


def test_a_way_of_many_turns_takes_no_more_room_than_its_rows():
    """Each row has two corners of each curve; between them these are straight, and add up to 1."""
    q = np.linspace(-3.0, 600.0, 500)
    log = Log(q, np.cos(q), np.sign(np.sin(q)), np.zeros_like(q))
    columns = _columns(log, 0.0, 500.0, 2.0 * np.pi)
    inside = (q >= 0.0) & (q <= 500.0)
    assert columns.nnz <= 6 * len(q)
    plain, fast, way = (part.sum(axis=1) for part in np.split(columns.toarray(), 3, axis=1))
    assert np.allclose(plain, inside)
    assert np.allclose(fast, inside * log.v)
    assert np.allclose(way, inside * log.sign)
    corners = np.linspace(0.0, 500.0, columns.shape[1] // 3)
    assert np.allclose(
        (columns @ np.tile(corners, 3))[inside], (q * (1 + log.v + log.sign))[inside]
    )
