"""MATLAB's files: version 5 (`save -v6`, `-v7`) by SciPy, 7.3 as the HDF5 that it is.

A vector is a column of its name, a matrix one for each of its columns, `data(1)`, `data(2)` ...,
a field of a structure `log.current`, of an array of structures `log(2).current`; alike in both
versions.  Nothing in the file is executed, and what it unpacks to is counted before it is read.
"""

import io
import struct
import zlib
from collections.abc import Iterator

import numpy as np

from spirob.logs.readers.columns import Asked, Table, spread
from spirob.logs.readers.hdf5 import read_matlab

KIND = "MATLAB file"
SUFFIXES = {".mat"}
NEEDS = ("scipy.io",)

LARGEST = 2**28  # bytes of the file, and of all that it unpacks to
HEADER = 128
COMPRESSED = 15
DEEPEST = 4  # structures within structures
MOST = 100  # structures in an array of them
OWN = ("MatlabOpaque", "MatlabFunction")
OPAQUE = "objects of MATLAB (table, timeseries); save struct('t', t, ...) instead"


def read(asked: Asked) -> Table:
    """Columns by name; what is an object of MATLAB's own is told as such."""
    if asked.path.stat().st_size > LARGEST:
        raise ValueError(f"more than {LARGEST >> 20} MiB; use Parquet")
    content = asked.path.read_bytes()
    if content.startswith(b"MATLAB 7.3"):
        return read_matlab(asked)
    _count(content)
    return _loaded(content, asked.name)


def _loaded(content: bytes, name: str) -> Table:
    from scipy.io import loadmat

    from spirob.logs.readers.columns import add

    table = Table(name)
    for variable, value in loadmat(io.BytesIO(content)).items():  # type: ignore[arg-type]
        if variable.startswith("__") or not isinstance(value, np.ndarray):
            continue
        if type(value).__name__ in OWN:
            table.text[variable] = OPAQUE
            continue
        for label, values in _flatten(variable, value, 0):
            add(table, label, values)
    return table


def _count(content: bytes) -> None:
    """Raise ValueError where all variables together unpack to too much."""
    if len(content) < HEADER or content[126:128] not in (b"IM", b"MI"):
        raise ValueError("it has no header of version 5")
    head = struct.Struct("<II" if content[126:128] == b"IM" else ">II")
    at, left = HEADER, LARGEST
    while at + head.size <= len(content):
        kind, size = head.unpack_from(content, at)
        start, at = at + head.size, at + head.size + size
        if at > len(content):
            raise ValueError("it breaks off inside a variable")
        if kind == COMPRESSED:
            unpack = zlib.decompressobj()
            left -= len(unpack.decompress(content[start:at], left + 1))
        else:
            left -= size
        if left < 0:
            raise ValueError(f"it unpacks to more than {LARGEST >> 20} MiB")


def _flatten(name: str, value: np.ndarray, depth: int) -> Iterator[tuple[str, np.ndarray]]:
    if type(value).__name__ in OWN:
        return
    if value.dtype.names and depth < DEEPEST:
        for k in range(min(value.size, MOST)):
            label = name if value.size == 1 else f"{name}({k + 1})"
            for field in value.dtype.names:
                inner = value.flat[k][field]
                if isinstance(inner, np.ndarray):
                    yield from _flatten(f"{label}.{field}", inner, depth + 1)
    elif value.dtype == object:  # a cell array; of texts it is a column
        texts = [cell.flat[0] for cell in value.flat if _is_text(cell)]
        if len(texts) == value.size > 1:
            yield name, np.array(texts, object)
    elif value.dtype.kind in "fiub" and value.ndim == 2:
        yield from spread(name, value, "({})", 1)
    elif value.dtype.kind == "U":
        yield from spread(name, value)


def _is_text(cell: object) -> bool:
    return isinstance(cell, np.ndarray) and cell.dtype.kind == "U" and cell.size == 1
