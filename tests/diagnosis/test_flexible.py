"""The flexible ceiling: at the noise where only noise is left, far below a law that was missed."""

import os
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from spirob.diagnosis.criteria import half_seconds
from spirob.diagnosis.flexible import ceiling
from spirob.identify.problem import Stretch

SECONDS = np.arange(800) * 0.01
NOISE = 0.002


def trials(rng, count, still=False):
    """A problem of trials of 8 s with one motor that swings, or stands, and further signals."""
    stretches = []
    for k in range(count):
        rate, phase = rng.uniform(1.5, 4.0), rng.uniform(0.0, 6.0)
        swing = 0.0 if still else 0.05
        position = swing * np.sin(rate * SECONDS + phase)
        velocity = swing * rate * np.cos(rate * SECONDS + phase)
        noise = NOISE * rng.normal(size=len(SECONDS))
        modelled = 0.3 + 2.0 * position
        stretches.append(
            Stretch(
                f"t{k}", "left motor", SECONDS, position, velocity, modelled + noise, 1e-3, "", ""
            )
        )
    # each trial ends with as many samples of a further signal, which are none of the effort
    measured = np.concatenate([np.concatenate([s.effort, s.effort + 9.0]) for s in stretches])
    samples = len(SECONDS)
    return SimpleNamespace(
        stretches=lambda: stretches,
        measured=lambda: measured,
        edges=np.arange(count + 1) * 2 * samples,
        rows=np.tile(np.repeat([True, False], samples), count),
    )


def left_of(missing, still=False):
    """What the model misses, RMS before and with a flexible residual, on held-out trials.

    missing  of the velocity, what the model leaves out beside the noise
    """
    rng = np.random.default_rng(3)
    problems = {role: trials(rng, n, still) for role, n in (("train", 4), ("heldout", 2))}
    missed = {}
    for role, problem in problems.items():
        values = np.full(len(problem.rows), 9.0)  # of the further signals: not to be looked at
        modelled = np.concatenate([0.3 + 2.0 * s.position for s in problem.stretches()])
        law = np.concatenate([missing(s.velocity) for s in problem.stretches()])
        values[problem.rows] = modelled - problem.measured()[problem.rows] - law
        missed[role] = values
    found = ceiling(problems, missed)
    before = missed["heldout"][problems["heldout"].rows]
    return rms(before), rms(found.left["heldout"]), found.share


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


@pytest.mark.parametrize("still", [False, True])
def test_noise_alone_is_not_explained(still):
    """At rest the measured effort is the noise itself: it must not be an input."""
    before, after, share = left_of(np.zeros_like, still)
    assert before == pytest.approx(NOISE, rel=0.05)
    assert after == pytest.approx(NOISE, rel=0.05)
    assert share < 0.02


def test_a_smooth_law_of_the_velocity_is_explained_down_to_the_noise():
    before, after, share = left_of(lambda v: 0.02 * np.tanh(v / 0.05))
    assert before > 5 * NOISE
    assert after < 1.5 * NOISE
    assert share > 0.9


def test_no_more_is_left_than_there_was():
    """Trees that learned something else are taken by what they are worth, down to nothing."""
    rng = np.random.default_rng(8)
    problems = {role: trials(rng, 1) for role in ("train", "heldout")}
    drift = {r: np.cumsum(rng.normal(size=len(p.rows))) for r, p in problems.items()}
    found = ceiling(problems, drift)
    rows = problems["train"].rows
    assert rms(found.left["train"]) <= rms(drift["train"][rows])


def test_motors_of_one_trial_share_their_half_seconds():
    pieces = [
        Stretch(trial, channel, SECONDS[:200], *[SECONDS[:200]] * 3, 1e-3, "", "")
        for trial in ("a", "b")
        for channel in ("left motor", "right motor")
    ]
    first, second, other, _ = np.split(
        half_seconds(SimpleNamespace(stretches=lambda: pieces)), [200, 400, 600]
    )
    assert np.array_equal(first, second)
    assert not set(first) & set(other)
    assert np.array_equal(np.unique(first, return_counts=True)[1], [50] * 4)


THREADS = """
from threadpoolctl import threadpool_info
from spirob.diagnosis.flexible import one_thread, tree
with one_thread():
    tree().fit([[0.0], [1.0]], [0.0, 1.0])
    print({(lib["user_api"], lib["num_threads"]) for lib in threadpool_info()})
"""


def test_the_trees_have_one_thread_though_their_library_was_not_loaded_before():
    env = {**os.environ, "OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "2"}
    said = subprocess.check_output([sys.executable, "-c", THREADS], env=env, text=True)
    assert eval(said) == {("openmp", 1), ("blas", 1)}
