"""A worker that is killed in the midst of a case loses nothing: the case is run again."""

import json
import os
import signal
import time
from functools import partial
from unittest.mock import patch

import pytest
from joblib.externals.loky.process_executor import TerminatedWorkerError

from spirob.campaign import results
from spirob.campaign.arm import running
from spirob.campaign.arm.case import Case

CASES = [Case("none", seed) for seed in range(4)]
TABLE = "cases.jsonl"
PLAY_ONE = running._one  # pickled by its name: what a worker really runs


def fake(case, settings):
    result = {"kind": "none", "seed": case.seed, "robot": case.robot, "without": False}
    result |= {"build": case.build}
    result |= {"verdict": "nothing_missing", "named": [], "probability": 1.0}
    return [{**result, "heldout": {"base": 0.01, "named": 0.01, "oracle": 0.01}}]


def killed_at_the_last(folder, case, settings):
    """In a worker: the last case kills it the first time, once another case has its result."""
    (folder / f"begun-{case.seed}").open("a").write("x")
    if case == CASES[-1] and not (folder / "killed").exists():
        _wait_for(lambda: running.known(folder / TABLE))
        done = [one["seed"] for one in running.known(folder / TABLE)]
        (folder / "killed").write_text(json.dumps(done))
        os.kill(os.getpid(), signal.SIGKILL)
    with patch.object(running, "run", fake):
        return PLAY_ONE(case, settings)


def killed_always(case, settings):
    os.kill(os.getpid(), signal.SIGKILL)


def _wait_for(done) -> None:
    for _ in range(1000):
        if done():
            return
        time.sleep(0.02)


def test_a_killed_worker_loses_no_case(tmp_path, monkeypatch):
    monkeypatch.setattr(running, "_one", partial(killed_at_the_last, tmp_path))
    said = []
    played = running.play(CASES, tmp_path / TABLE, workers=2, tell=said.append)
    assert [one["seed"] for one in played] == [0, 1, 2, 3]
    assert sum(text.startswith("a worker was killed") for text in said) == 1
    assert running.left(CASES, running.known(tmp_path / TABLE)) == []
    times = {case.seed: len((tmp_path / f"begun-{case.seed}").read_text()) for case in CASES}
    assert times[3] == 2  # the one that was killed
    done = json.loads((tmp_path / "killed").read_text())
    assert done
    assert all(times[seed] == 1 for seed in done)  # what had its result was not run again


def test_a_case_that_kills_every_worker_ends_the_trial(tmp_path, monkeypatch):
    monkeypatch.setattr(running, "_one", killed_always)
    monkeypatch.setattr(results, "ATTEMPTS", 2)  # each begins two workers anew
    said = []
    with pytest.raises(TerminatedWorkerError):
        running.play(CASES[:2], tmp_path / TABLE, workers=2, tell=said.append)
    assert len(said) == 2
