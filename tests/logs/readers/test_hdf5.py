"""HDF5: only what lies in the file itself is read, and no more than fits."""

import h5py
import numpy as np
import pytest

from spirob.errors import DataError
from spirob.logs.readers import read_table

T = np.arange(30) * 0.1
RECORDS = np.zeros(30, [("t", float), ("q", np.float32)])


def test_groups_matrices_records_and_texts(tmp_path):
    RECORDS["q"] = T
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["run/t"], file["run/data"], file["run/rows"] = T, np.column_stack([T, 2 * T]), RECORDS
        file["when"] = [f"2025-01-31 12:00:{k:02d}" for k in range(30)]
        file["run/gain"] = 5.0
    table = read_table(tmp_path / "a.h5")
    assert set(table.columns) == {
        "run.t", "run.data[0]", "run.data[1]", "run.rows.t", "run.rows.q", "when",
    }  # fmt: skip
    np.testing.assert_array_equal(table.column("run.data[1]"), 2 * T)
    np.testing.assert_array_equal(table.column("when"), np.arange(30))
    assert table.units == {"when": "s"}


def test_nothing_outside_of_the_file_is_read(tmp_path):
    np.arange(30.0).tofile(tmp_path / "secret.raw")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["secret"] = T
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["t"] = T
        file["out"] = h5py.ExternalLink("other.h5", "/secret")
        file["soft"] = h5py.SoftLink("/t")
        outside = [(str(tmp_path / "secret.raw"), 0, h5py.h5f.UNLIMITED)]
        file.create_dataset("raw", (30,), float, external=outside)
        layout = h5py.VirtualLayout((30,), float)
        layout[:] = h5py.VirtualSource(str(tmp_path / "other.h5"), "secret", (30,))
        file.create_virtual_dataset("virtual", layout)
    table = read_table(tmp_path / "a.h5")
    assert list(table.columns) == ["t"]
    for name in ("out", "soft", "raw", "virtual"):
        with pytest.raises(DataError, match=f"'{name}' holds .*not (followed|read)"):
            table.column(name)


def test_groups_that_hold_themselves_end(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        group = file.create_group("g")
        group["t"] = T
        group["again"] = group
    with pytest.raises(DataError, match="groups within groups"):
        read_table(tmp_path / "a.h5")


def test_a_size_that_is_only_claimed_is_refused(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("t", (2**40,), float, chunks=(2**16,), compression="gzip")
    with pytest.raises(DataError, match="unpacks to more than 256 MiB, at 't'"):
        read_table(tmp_path / "a.h5")
