"""A missing file is told by name and stage, or has its sentence on the page.

Lateness of the loop: from the log of a trial through its trace to the page.
"""

import shutil
from dataclasses import replace

import numpy as np
import pytest

from spirob.can.robot import Lateness
from spirob.errors import DataError, MissingChannel, MissingLog
from spirob.logs import write_parquet
from spirob.logs.trace import Trace
from spirob.report import load
from spirob.report.data import SOURCES, read_loops
from spirob.report.sections.loop import Loop

REQUIRED = [name for name, source in SOURCES.items() if source.why is None]


@pytest.fixture
def copy(run, tmp_path):
    return shutil.copytree(run, tmp_path / "run")


@pytest.mark.parametrize("name", REQUIRED)
def test_a_missing_required_file_names_itself_and_its_stage(copy, name):
    source = SOURCES[name]
    (copy / source.path).unlink()
    with pytest.raises(MissingLog, match=f"{source.path} is missing.*'{source.stage}'"):
        load(copy)


def test_a_missing_optional_file_leaves_its_reason(sparse):
    assert set(sparse.absent) == set(SOURCES) - set(REQUIRED)
    assert sparse.absent["sweep"] == "No sweep was run here (data/sweep/table.json is absent)."


def test_broken_json_is_a_sentence(copy):
    (copy / "data/compare/compare.json").write_text("{")
    with pytest.raises(DataError, match=r"compare.json cannot be read.*stage 'compare'"):
        load(copy)


def test_a_missing_key_lists_what_is_there(copy):
    (copy / "data/compare/compare.json").write_text('{"runs": []}')
    with pytest.raises(MissingChannel, match="'trials' is missing; present: runs"):
        load(copy)


def test_a_diagnosis_of_another_version_is_a_sentence(copy):
    path = copy / "data/diagnosis/diagnosis.json"
    path.write_text(path.read_text().replace('"format": 1', '"format": 0', 1))
    with pytest.raises(DataError, match=r"it states format 0, where 1 is read.*stage 'decide'"):
        load(copy)


def test_every_file_read_is_hashed(data, run):
    assert set(data.provenance.hashes) == {source.path for source in SOURCES.values()}
    assert data.provenance.seed == "recordings.seed = 7, diagnose.seed = 11"


def test_a_lesser_file_is_read_where_the_full_one_is_absent(copy):
    full = copy / SOURCES["trial"].path
    full.rename(copy / SOURCES["trial"].instead)
    data = load(copy)
    assert data.trial["cases"] == 62
    assert SOURCES["trial"].instead in data.provenance.hashes
    assert "trial" not in data.absent


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
