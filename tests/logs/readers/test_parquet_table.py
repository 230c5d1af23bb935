"""Parquet: numbers, dates, lists and structures; and no more of it than fits."""

import decimal

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from spirob.errors import DataError
from spirob.logs.readers import parquet_table, read_table
from spirob.logs.readers.columns import Asked

N = 50


def written(folder, **columns):
    pq.write_table(pa.table(columns), folder / "a.parquet")
    return folder / "a.parquet"


@pytest.mark.parametrize(
    ("column", "seconds"),
    [
        (pa.array(10**9 + np.arange(N), pa.timestamp("us")), 1e-6),
        (pa.array(10**9 + np.arange(N), pa.timestamp("ns", "Europe/Berlin")), 1e-9),
        (pa.array(np.arange(N), pa.duration("ms")), 1e-3),
        (pa.array(np.arange(N), pa.time64("us")), 1e-6),
        (pa.array(np.arange(N, dtype=np.int32), pa.date32()), 86400.0),
        (pa.array(pd.to_datetime(np.arange(N), unit="s").strftime("%Y-%m-%d %H:%M:%S")), 1.0),
    ],
)
def test_times_are_seconds_since_the_first(tmp_path, column, seconds):
    table = read_table(written(tmp_path, t=column, q=np.zeros(N)))
    np.testing.assert_allclose(table.column("t"), seconds * np.arange(N), rtol=1e-12)
    assert table.units == {"t": "s"}


@pytest.mark.parametrize("unit", ["ms", "us"])
def test_years_that_nanoseconds_do_not_reach_are_told_as_they_are(tmp_path, unit):
    first = np.datetime64("9999-12-31T23:59:30", "ms")
    stamps = (first + np.arange(N)).astype(f"datetime64[{unit}]")
    table = read_table(written(tmp_path, t=pa.array(stamps), q=np.zeros(N)))
    np.testing.assert_allclose(table.column("t"), 1e-3 * np.arange(N), rtol=1e-12)
    assert table.said[0].endswith("seconds since 9999-12-31T23:59:30.000 (UTC).")


def test_what_is_missing_is_not_a_number(tmp_path):
    stamps = pa.array([None, *range(1, N)], pa.timestamp("us"))
    table = read_table(written(tmp_path, t=stamps, k=pa.array([1, None] * (N // 2))))
    assert np.flatnonzero(np.isnan(table.column("t"))).tolist() == [0]
    assert np.isnan(table.column("k")).sum() == N // 2


def test_numbers_of_all_kinds_lists_and_structures(tmp_path):
    table = read_table(
        written(
            tmp_path,
            on=pa.array([True, False] * (N // 2)),
            money=pa.array([decimal.Decimal("1.25")] * N),
            text=["x"] * N,
            position=[[k, -k] for k in range(N)],
            lone=[[k] for k in range(N)],
            ragged=[[0.0] * (k % 3) for k in range(N)],
            pose=[{"at": {"x": float(k)}, "label": "a"} for k in range(N)],
        )
    )
    assert table.column("on").tolist() == [1.0, 0.0] * (N // 2)
    assert table.column("money")[0] == 1.25
    for name in ("lone", "lone[0]", "position[0]", "pose.at.x"):
        np.testing.assert_array_equal(table.column(name), np.arange(N))
    np.testing.assert_array_equal(table.column("position[1]"), -np.arange(N))
    for name in ("text", "ragged", "pose.label"):
        with pytest.raises(DataError, match=f"'{name}' holds .*, not numbers"):
            table.column(name)


def test_of_a_large_file_only_what_is_wanted_is_read(tmp_path, monkeypatch):
    rows = 400_000
    columns = {f"c{k}": pa.array(np.full(rows, k)) for k in range(60)}
    path = written(tmp_path, **columns)
    table = read_table(path, ["c7", "c9"])
    assert list(table.columns) == ["c7", "c9"]
    assert "c8" in table.others
    assert len(table.column("c7")) == rows
    assert 8 * rows * len(columns) > parquet_table.LIGHT
    with pytest.raises(DataError, match=r"more than (512|1024) MiB"):
        read_table(written(tmp_path, **{f"c{k}": columns["c0"] for k in range(190)}))


def test_of_two_columns_of_one_name_the_first_is_used_and_said(tmp_path, monkeypatch):
    columns = [pa.array(np.arange(float(N)) * k) for k in (1, 2, 3)]
    path = tmp_path / "a.parquet"
    pq.write_table(pa.Table.from_arrays(columns, names=["t", "q", "q"]), path)
    for light in (parquet_table.LIGHT, 1):
        monkeypatch.setattr(parquet_table, "LIGHT", light)
        table = parquet_table.read(Asked(path, ("t", "q")))
        np.testing.assert_array_equal(table.column("q"), 2.0 * np.arange(N))
        assert table.said == ["a.parquet: 2 columns are called 'q'; the first is used."]
