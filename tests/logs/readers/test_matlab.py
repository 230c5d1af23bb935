"""MATLAB's two formats are named alike; what neither can hold as numbers is told."""

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from spirob.errors import DataError
from spirob.logs.readers import matlab, read_table
from spirob.logs.readers.columns import Asked

T = np.arange(40) * 0.01
PAIR = np.column_stack([np.sin(T), np.cos(T)])
DATES = [f"2025-01-31 12:00:{k:02d}" for k in range(40)]


def five(path):
    cells = np.empty(40, object)
    cells[:] = DATES
    parts = np.zeros((1, 2), [("q", object), ("gain", object)])
    parts[0, 0]["q"], parts[0, 1]["q"] = T, 2 * T
    parts["gain"] = 3.0
    inside = {"t": T, "deep": {"q": PAIR[:, 0]}, "gain": 5.0, "name": "bench"}
    savemat(path, {"log": inside, "data": PAIR, "part": parts, "k": np.arange(40), "when": cells})


def class_of(item, name):
    item.attrs["MATLAB_class"] = np.bytes_(name)


def seven(path):
    """As MATLAB writes it: arrays turned, cells and arrays of structures by reference."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in {
            "log/t": T[None],
            "log/deep/q": PAIR[:, :1].T,
            "log/gain": [[5.0]],
            "data": PAIR.T,
            "k": np.arange(40, dtype=np.int32)[None],
        }.items():
            file[name] = values
            class_of(file[name], "double")
        file["log/name"] = np.array([[ord(c) for c in "bench"]], np.uint16).T
        class_of(file["log/name"], "char")
        for group in ("log", "log/deep", "#refs#"):
            class_of(file.require_group(group), "struct")
        part = file.create_group("part")
        class_of(part, "struct")
        for field, values in {"q": [T[None], 2 * T[None]], "gain": [[[3.0]], [[3.0]]]}.items():
            held = part.create_dataset(field, (2, 1), h5py.ref_dtype)
            for k, value in enumerate(values):
                file[f"#refs#/{field}{k}"] = value
                held[k, 0] = file[f"#refs#/{field}{k}"].ref
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")


@pytest.mark.parametrize("write", [five, seven])
def test_structures_and_matrices_are_named_alike(write, tmp_path):
    write(tmp_path / "a.mat")
    table = read_table(tmp_path / "a.mat")
    expected = {
        "log.t": T,
        "log.deep.q": PAIR[:, 0],
        "data(1)": PAIR[:, 0],
        "data(2)": PAIR[:, 1],
        "part(1).q": T,
        "part(2).q": 2 * T,
        "k": np.arange(40.0),
    }
    assert set(table.columns) - {"when"} == set(expected)
    for name, values in expected.items():
        np.testing.assert_array_equal(table.column(name), values)


def test_a_cell_array_of_dates_is_time(tmp_path):
    five(tmp_path / "a.mat")
    np.testing.assert_array_equal(read_table(tmp_path / "a.mat").column("when"), np.arange(40))


def test_the_longer_side_of_a_matrix_is_time(tmp_path):
    savemat(tmp_path / "a.mat", {"wide": PAIR.T})
    np.testing.assert_array_equal(read_table(tmp_path / "a.mat").column("wide(2)"), PAIR[:, 1])


def test_objects_of_matlab_are_told_as_such(tmp_path):
    with h5py.File(tmp_path / "a.mat", "w", userblock_size=512) as file:
        file["t"] = T[None]
        file["table"] = np.zeros((6, 1), np.uint32)
        class_of(file["table"], "table")
        file["table"].attrs["MATLAB_object_decode"] = 3
    with (tmp_path / "a.mat").open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    table = read_table(tmp_path / "a.mat")
    assert list(table.columns) == ["t"]
    with pytest.raises(DataError, match=r"objects of MATLAB .a table"):
        table.column("table")


def test_what_unpacks_to_too_much_is_refused_before(tmp_path, monkeypatch):
    savemat(tmp_path / "a.mat", {"bomb": np.zeros(2**18)}, do_compression=True)
    monkeypatch.setattr(matlab, "LARGEST", 2**20)
    with pytest.raises(ValueError, match="unpacks to more than 1 MiB"):
        matlab.read(Asked(tmp_path / "a.mat"))


def test_what_is_no_matlab_file_is_refused(tmp_path):
    for content in (b"", b"MATLAB 5.0", b"MATLAB 7.3 MAT-file".ljust(600), bytes(300)):
        (tmp_path / "a.mat").write_bytes(content)
        with pytest.raises(DataError, match="this is no readable MATLAB file"):
            read_table(tmp_path / "a.mat")
