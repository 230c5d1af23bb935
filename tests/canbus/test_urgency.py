"""The loop takes what the system allows, says what it does not, and leaves all as it was."""

import gc
import os

import pytest

from spirob.canbus.deadlines import PRIORITY, Urgency


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
