"""A missing file is told by name and stage, or has its sentence on the page."""

import shutil

import pytest

from spirob.errors import DataError, MissingChannel, MissingLog
from spirob.report import load
from spirob.report.data import SOURCES

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


def test_every_file_read_is_hashed(data, run):
    assert set(data.provenance.hashes) == {source.path for source in SOURCES.values()}
    assert data.provenance.seed == "experiment.seed = 7, diagnose.seed = 11"


def test_a_lesser_file_is_read_where_the_full_one_is_absent(copy):
    full = copy / SOURCES["trial"].path
    full.rename(copy / SOURCES["trial"].instead)
    data = load(copy)
    assert data.trial["cases"] == 62
    assert SOURCES["trial"].instead in data.provenance.hashes
    assert "trial" not in data.absent
