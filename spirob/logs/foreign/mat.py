"""Numeric variables of a MATLAB file of version 5 (`save -v6` or `-v7`) as columns.

A vector is a column of its name, a matrix one for each of its columns, `data(1)`, `data(2)` ...,
and a field of a structure `log.current`.  Nothing in the file is executed, and what it unpacks to
is counted before it is read.
"""

import io
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.io import loadmat
from scipy.io.matlab import MatReadError

from spirob.errors import DataError, MissingLog
from spirob.logs.foreign.apart import apart

LARGEST = 2**28  # bytes of the file, and of all that it unpacks to
HEADER = 128
COMPRESSED = 15
DEEPEST = 4  # structures within structures
_BROKEN = (
    MatReadError,
    ValueError,
    TypeError,
    KeyError,
    IndexError,
    OverflowError,
    NotImplementedError,
    EOFError,
    OSError,
    MemoryError,
    RecursionError,
    struct.error,
    zlib.error,
)


def read_mat(path: Path | str) -> dict[str, np.ndarray]:
    """Columns by name; raises MissingLog, and DataError where the file cannot be used."""
    path = Path(path)
    if not path.is_file():
        raise MissingLog(f"{path}: there is no such log")
    if path.stat().st_size > LARGEST:
        raise DataError(f"{path}: more than {LARGEST >> 20} MiB; use Parquet")
    content = path.read_bytes()
    if content.startswith(b"MATLAB 7.3"):
        raise DataError(f"{path}: is of version 7.3; save it with -v7")
    try:
        _count(content)
        columns = apart(_loaded, content)
    except _BROKEN as error:
        said = " ".join(str(error).split())[:200] or type(error).__name__
        raise DataError(f"{path}: is no readable MATLAB file of version 5: {said}") from None
    if not columns:
        raise DataError(f"{path}: holds no numeric variable")
    return columns


def _loaded(content: bytes) -> dict[str, np.ndarray]:
    found = loadmat(io.BytesIO(content), chars_as_strings=False)  # type: ignore[arg-type]
    return dict(_columns(found))


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


def _columns(found: dict[str, object]) -> Iterator[tuple[str, np.ndarray]]:
    for name, value in found.items():
        if not name.startswith("__") and isinstance(value, np.ndarray):
            yield from _flatten(name, value, 0)


def _flatten(name: str, value: np.ndarray, depth: int) -> Iterator[tuple[str, np.ndarray]]:
    if value.dtype.names and value.size == 1 and depth < DEEPEST:
        for field in value.dtype.names:
            inner = value.flat[0][field]
            if isinstance(inner, np.ndarray):
                yield from _flatten(f"{name}.{field}", inner, depth + 1)
    elif value.dtype.kind in "fiub" and value.ndim == 2 and value.size > 1:
        if 1 in value.shape:
            yield name, value.ravel().astype(float)
        else:
            for k in range(value.shape[1]):
                yield f"{name}({k + 1})", value[:, k].astype(float)
