"""The same log is the same table, whatever it is kept as; what is none is refused in a sentence."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from spirob.errors import DataError, MissingChannel, MissingLog
from spirob.logs.readers import Table, kinds, read_table
from tests.logs.readers.same_log import AMP, FRAME, KINDS, TIME, N, Q

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("wanting", [True, False])
@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_gives_the_same_columns(kind, wanting, tmp_path):
    log = KINDS[kind](tmp_path)
    if not wanting:  # without names a label of a joint stands where it can
        log.q = log.q.replace("[0]", "[elbow]") if log.q.startswith("/") else log.q
    table = read_table(log.path, log.names if wanting else (), log.dbc)
    time = table.column(log.time)
    coarse = kind in ("asc", "candump")  # they write microseconds
    np.testing.assert_allclose(time - time[0], TIME, atol=2e-6 if coarse else 1e-9)
    np.testing.assert_allclose(table.column(log.q), Q, atol=1e-9)
    np.testing.assert_allclose(table.column(log.amp), AMP, atol=1e-9)
    assert all(values.shape == (N,) for values in table.columns.values())
    assert all(values.dtype == float for values in table.columns.values())
    assert table.units.get(log.time, "s") == "s"
    assert table.name == log.path.name


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_missing_is_answered_with_what_is_there(kind, tmp_path):
    log = KINDS[kind](tmp_path)
    table = read_table(log.path, [log.time, "speed"], log.dbc)
    table.column(log.time)
    with pytest.raises(MissingChannel, match="'speed' is missing; present: ") as told:
        table.column("speed")
    present = str(told.value).partition("present: ")[2].split(", ")
    assert log.amp in present


def test_a_part_of_a_name_is_enough_where_it_is_unique(tmp_path):
    log = KINDS["hdf5"](tmp_path)
    np.testing.assert_array_equal(read_table(log.path, ["q"]).column("q"), Q)


def test_what_is_no_log_is_refused(tmp_path):
    (tmp_path / "empty").mkdir()
    for name in ("a.parquet", "a.mcap", "a.xls", "a.mat", "a.npz", "a.json", "a.h5", "a.bag"):
        (tmp_path / name).write_bytes(b"PAR1 no table")
    for name in [*os.listdir(tmp_path), "empty"]:
        with pytest.raises(DataError, match=name):
            read_table(tmp_path / name)
    with pytest.raises(DataError, match=r"known: \.asc \.bag \.blf \.csv"):
        read_table(tmp_path / "a.xls")
    with pytest.raises(MissingLog, match="there is no such log"):
        read_table(tmp_path / "absent.csv")


def test_any_name_of_a_file_can_be_told(tmp_path):
    path = tmp_path / os.fsdecode(b"log\xff.csv")
    try:
        FRAME.to_csv(path, index=False)
    except OSError:
        pytest.skip("names are text here")
    table = read_table(path)
    table.name.encode()
    with pytest.raises(MissingChannel) as told:
        table.column("x")
    str(told.value).encode()
    for name in ("a\0b.csv", os.fsdecode(b"\xff.parquet"), "x" * 5000 + ".csv"):
        with pytest.raises(DataError) as told:
            read_table(tmp_path / name)
        str(told.value).encode()


def test_of_many_names_the_nearest_forty_are_told():
    table = Table("a.csv", {f"motor{k}.current": np.zeros(2) for k in range(500)})
    with pytest.raises(MissingChannel, match="and 460 more") as told:
        table.column("motor77.curent")
    assert "motor77.current" in str(told.value)
    assert len(str(told.value)) < 4000


def test_text_is_told_with_an_example(tmp_path):
    FRAME.assign(mode="position " * 50).to_csv(tmp_path / "a.csv", index=False)
    table = read_table(tmp_path / "a.csv")
    with pytest.raises(DataError, match="'mode' holds text such as 'position position") as told:
        table.column("mode")
    assert len(str(told.value)) < 300


def test_a_script_of_a_user_is_not_run_again(tmp_path):
    log = KINDS["parquet"](tmp_path)
    script = tmp_path / "mine.py"
    script.write_text(
        "from spirob.logs.readers import read_table\n"
        f"print(len(read_table({str(log.path)!r}).column('q')))\n"
    )
    asked = [sys.executable, str(script)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    answer = subprocess.run(asked, env=environment, capture_output=True, text=True, timeout=120)
    assert answer.stdout == f"{N}\n", answer.stderr


def test_readers_load_their_libraries_when_they_read():
    code = "import sys, spirob.logs.readers as r; r.kinds(); print(*sys.modules)"
    asked = [sys.executable, "-c", code]
    answer = subprocess.run(asked, cwd=ROOT, capture_output=True, text=True, timeout=120)
    loaded = set(answer.stdout.split())
    assert "spirob.logs.readers.hdf5" in loaded
    assert not loaded & {"h5py", "rosbags.typesys", "scipy.io", "google.protobuf", "pandas"}


def test_a_suffix_belongs_to_one_kind():
    suffixes = [suffix for kind in kinds() for suffix in kind.SUFFIXES]
    assert len(suffixes) == len(set(suffixes))
