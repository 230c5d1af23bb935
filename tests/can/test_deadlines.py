"""How late cycles ended is in the log of a robot in real time.

The loop takes what the system allows, says what it does not, and leaves all as it was.
"""

import gc
import os
import threading
import time

import numpy as np
import pytest

from spirob.can.bus import open_bus
from spirob.can.limits import Limits
from spirob.can.robot import EDGES, PRIORITY, CanRobot, Lateness, Urgency
from spirob.logs import read_log
from spirob.logs.writer import TrialLog
from spirob.plant import Rig
from spirob.trials import Trial, record
from tests.can.fake_drives import FakeDrives
from tests.can.stalls import steady
from tests.trials.trials import plain_trial


def test_figures_and_bins_are_those_of_the_cycles():
    lateness = Lateness()
    assert lateness.summary() == {}
    values = np.r_[np.full(98, 15_000), 700_000, 30_000_000]  # ns
    for value in values:
        lateness.ended(int(value))
    found = lateness.summary()
    assert found["cycles"] == "100"
    assert float(found["lateness_p50_us"]) == 15.0
    assert float(found["lateness_p99_us"]) == pytest.approx(
        np.percentile(values, 99) / 1e3, abs=0.1
    )
    assert float(found["lateness_max_us"]) == 30_000.0
    counts = dict(zip(EDGES, map(int, found["histogram"].split()), strict=True))
    assert {edge: n for edge, n in counts.items() if n} == {10: 98, 500: 1, 10000: 1}
    lateness.restart()
    assert lateness.summary() == {}


@steady
def test_a_trial_on_a_bus_says_how_late_its_cycles_were_and_does_not_wait_for_its_log(
    tmp_path, monkeypatch
):
    threads, frames = set(), TrialLog.frames

    def slow(self, given):
        threads.add(threading.current_thread().name)
        time.sleep(2e-4)
        frames(self, given)

    monkeypatch.setattr(TrialLog, "frames", slow)
    channel = f"lateness-{id(tmp_path)}"
    with FakeDrives(channel):
        robot = CanRobot(
            open_bus("virtual", channel), silence_ns=900_000_000, ask=lambda question: "arm"
        )
        path = record(
            Trial.from_plain(plain_trial(0.3)),
            robot,
            tmp_path / "t.mcap",
            Rig(name="fake"),
            limits=Limits(silence=0.9, following=40.0, frozen=10.0),  # a busy machine, crude drives
        )
        robot.close()
    assert threads == {"log"}
    loop = read_log(path).meta["loop"]
    assert int(loop["cycles"]) >= 300
    assert sum(map(int, loop["histogram"].split())) == int(loop["cycles"])
    assert loop["priority"] == "not asked for"
    assert int(loop["skipped"]) >= 0


@pytest.fixture
def scheduler(monkeypatch):
    """What was asked of the system, without asking it."""
    asked = []
    monkeypatch.setattr(os, "sched_setscheduler", lambda *given: asked.append(given), raising=False)
    return asked


def test_priority_is_taken_and_given_back(scheduler):
    urgency, before = Urgency(), (os.sched_getscheduler(0), os.sched_getparam(0))
    urgency.take()
    urgency.take()
    assert not gc.isenabled()
    assert urgency.lacking == ""
    urgency.give_back()
    urgency.give_back()
    assert gc.isenabled()
    assert scheduler == [(0, os.SCHED_FIFO, os.sched_param(PRIORITY)), (0, *before)]


def test_where_it_is_not_allowed_that_is_said(monkeypatch):
    def refuse(*given):
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    urgency = Urgency()
    urgency.take()
    assert urgency.lacking.startswith("no real-time priority: Operation not permitted")
    assert not gc.isenabled()
    urgency.give_back()
    assert gc.isenabled()


def test_a_disabled_collector_stays_disabled(scheduler):
    gc.disable()
    try:
        urgency = Urgency()
        urgency.take()
        urgency.give_back()
        assert not gc.isenabled()
    finally:
        gc.enable()
