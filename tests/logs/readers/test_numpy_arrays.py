"""NumPy's files: arrays of all shapes; objects are never loaded, bombs never unpacked."""

import io
import os
import pickle
import zipfile

import numpy as np
import pytest

from spirob.errors import DataError, MissingChannel
from spirob.logs.readers import read_table

T = np.arange(30) * 0.1


class Bomb:
    """Makes a folder when it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return os.mkdir, (self.path,)


def test_vectors_matrices_records_and_dates(tmp_path):
    records = np.zeros(30, [("q", float), ("u", np.int16)])
    records["q"] = T
    when = np.datetime64("2025-01-31T12:00:00") + np.arange(30)
    np.savez(
        tmp_path / "a.npz",
        t=T.astype(np.float32),
        data=np.vstack([T, 2 * T]),
        log=records,
        when=when,
        texts=when.astype(str),
        bytes=when.astype("S19"),
        gain=5.0,
        cube=np.zeros((3, 3, 3)),
    )
    table = read_table(tmp_path / "a.npz")
    np.testing.assert_array_equal(table.column("t"), T.astype(np.float32))
    np.testing.assert_array_equal(table.column("data[1]"), 2 * T)
    np.testing.assert_array_equal(table.column("log.q"), T)
    for name in ("when", "texts", "bytes"):
        np.testing.assert_array_equal(table.column(name), np.arange(30))
        assert table.units[name] == "s"
    assert not {"gain", "cube"} & set(table.columns)


@pytest.mark.parametrize("name", ["a.npz", "a.npy"])
def test_objects_are_never_loaded(tmp_path, name):
    objects = np.array([Bomb(str(tmp_path / "made"))] * 30, object)
    if name == "a.npz":
        np.savez(tmp_path / name, t=T, q=objects)
    else:
        np.save(tmp_path / name, objects)
    with pytest.raises(DataError, match="never loaded"):
        read_table(tmp_path / name).column("q")
    (tmp_path / "b.npz").write_bytes(pickle.dumps(Bomb(str(tmp_path / "made"))))
    with pytest.raises(DataError):
        read_table(tmp_path / "b.npz")
    assert not (tmp_path / "made").exists()


def test_columns_of_other_lengths_are_left_out_and_said(tmp_path):
    np.savez(tmp_path / "a.npz", t=T, q=T, gains=np.zeros(7))
    table = read_table(tmp_path / "a.npz")
    assert set(table.columns) == {"t", "q"}
    assert table.said == [
        "a.npz: columns of another length than 30 rows are left out: 'gains' (7)."
    ]
    assert len(read_table(tmp_path / "a.npz", ["gains"]).column("gains")) == 7
    with pytest.raises(MissingChannel):
        table.column("gains")
    with pytest.raises(DataError, match="'t' has 30 rows, 'gains' has 7 rows"):
        read_table(tmp_path / "a.npz", ["t", "gains"])


def test_what_unpacks_to_gigabytes_is_refused(tmp_path):
    with (
        zipfile.ZipFile(tmp_path / "a.npz", "w", zipfile.ZIP_DEFLATED) as archive,
        archive.open("q.npy", "w", force_zip64=True) as member,
    ):
        np.lib.format.write_array_header_1_0(
            member, {"descr": "<f8", "fortran_order": False, "shape": (2**26,)}
        )
        for _ in range(512):
            member.write(bytes(2**20))
    assert (tmp_path / "a.npz").stat().st_size < 2**20
    with pytest.raises(DataError, match="unpacks to more than 256 MiB"):
        read_table(tmp_path / "a.npz")


def test_a_size_that_is_only_claimed_is_refused(tmp_path):
    head = io.BytesIO()
    claimed = {"descr": "<f8", "fortran_order": False, "shape": (2**40,)}
    np.lib.format.write_array_header_1_0(head, claimed)
    (tmp_path / "a.npy").write_bytes(head.getvalue() + bytes(800))
    with pytest.raises(DataError, match="this is no readable NumPy file"):
        read_table(tmp_path / "a.npy")


def test_an_array_of_three_dimensions_is_told_or_is_a_column(tmp_path):
    np.savez(tmp_path / "a.npz", t=T, q=T.reshape(1, -1, 1), cube=np.zeros((30, 3, 3)))
    table = read_table(tmp_path / "a.npz", ["t", "q"])
    np.testing.assert_array_equal(table.column("q"), T)
    with pytest.raises(DataError, match="column 'cube' holds an array of 3 dimensions, not num"):
        table.column("cube")


def test_no_address_of_an_object_is_printed(tmp_path):
    head = b"{'descr': '<f8', 'fortran_order': False, 'shape': tuple((3,)), }".ljust(117) + b"\n"
    size = len(head).to_bytes(2, "little")
    (tmp_path / "a.npy").write_bytes(b"\x93NUMPY\x01\x00" + size + head + bytes(24))
    with pytest.raises(DataError, match=r"no readable NumPy file: malformed .* on line 1$"):
        read_table(tmp_path / "a.npy")


def test_an_archive_that_breaks_off_says_so(tmp_path):
    np.savez(tmp_path / "a.npz", q=np.arange(1000.0))
    content = (tmp_path / "a.npz").read_bytes()
    (tmp_path / "a.npz").write_bytes(content[: len(content) // 2])
    with pytest.raises(DataError, match=r"a\.npz: .* the archive breaks off"):
        read_table(tmp_path / "a.npz")
