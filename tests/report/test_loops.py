"""Lateness of the loop: from the log of a trial through its trace to the page."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.canbus.deadlines import Lateness
from spirob.logs import write_parquet
from spirob.report.data import read_loops
from spirob.report.sections.loop import Loop
from spirob.trace import Trace


def trace(name, late):
    lateness = Lateness()
    for value in late:
        lateness.ended(int(value))
    meta = {} if late is None else {"loop": {**lateness.summary(), "skipped": "2", "priority": "x"}}
    return Trace(name, np.arange(5) * 10**6, {"a": np.zeros(5)}, {"a": "A"}, meta)


@pytest.fixture
def loops(tmp_path):
    write_parquet(trace("one", [5_000] * 90 + [60_000] * 10), tmp_path / "one.parquet")
    write_parquet(trace("two", [15_000_000]), tmp_path / "two.parquet")
    plain = Trace("three", np.arange(5) * 10**6, {"a": np.zeros(5)}, {"a": "A"}, {})
    write_parquet(plain, tmp_path / "three.parquet")
    (tmp_path / "broken.parquet").write_bytes(b"PAR1")
    return read_loops(tmp_path)


def test_only_trials_in_real_time_have_a_loop(loops):
    assert list(loops) == ["one", "two"]
    assert loops["one"]["lateness_p50_us"] == 5.0
    assert sum(loops["one"]["counts"]) == 100


def test_the_section_shows_figures_and_adds_up_the_bins(loops, data):
    context = Loop().get_context(replace(data, loops=loops))
    assert context["rows"][0]["cells"][:2] == ["100", "2"]
    assert context["rows"][1]["cells"][4].replace("\u202f", "") == "15000"
    (bar,) = context["plot"].figure.data
    assert [int(text or 0) for text in bar.text] == [90, 0, 0, 10, 0, 0, 0, 0, 0, 0, 1]
    assert sum(bar.x) == pytest.approx(100.0)


def test_in_simulated_time_there_is_none(data):
    assert Loop().get_context(replace(data, loops={}))["rows"] == []
