"""NumPy's `.npz` and `.npy`.  Objects in them, which are pickles, are never loaded."""

import zipfile
from typing import IO

import numpy as np

from spirob.logs.readers.columns import Asked, Table, spread

KIND = "NumPy file"
SUFFIXES = {".npz", ".npy"}

LARGEST = 2**28  # bytes that all arrays unpack to
MOST = 5000  # arrays
ARCHIVE = b"PK\x03\x04"


def read(asked: Asked) -> Table:
    """Vectors by name, `q`; of matrices `data[0]`; of named fields `log.q`, in a lone array `q`."""
    table = Table(asked.name)
    if not zipfile.is_zipfile(asked.path):
        with asked.path.open("rb") as file:
            if file.read(len(ARCHIVE)) == ARCHIVE:
                raise ValueError("the archive breaks off")
            file.seek(0)
            _take(table, "", file)
        return table
    with zipfile.ZipFile(asked.path) as archive:
        inside = [i for i in archive.infolist() if i.filename.endswith(".npy")]
        if len(inside) > MOST or sum(i.file_size for i in inside) > LARGEST:
            raise ValueError(f"it unpacks to more than {LARGEST >> 20} MiB or {MOST} arrays")
        for one in inside:
            with archive.open(one) as member:
                name = one.filename.removesuffix(".npy")
                _take(table, "" if len(inside) == 1 and name == "arr_0" else name, member)
    return table


def _take(table: Table, name: str, file: IO[bytes]) -> None:
    from spirob.logs.readers.columns import add

    try:
        array = np.lib.format.read_array(file, allow_pickle=False)
    except ValueError as error:
        if not str(error).startswith("Object arrays"):
            raise
        if not name:
            raise ValueError("it holds Python objects (a pickle), which are never loaded") from None
        table.text[name] = "Python objects (a pickle), which are never loaded"
        return
    if array.squeeze().ndim > 2:
        table.text[name or "column"] = f"an array of {array.ndim} dimensions"
    for label, values in spread(name if name or array.dtype.names else "column", array):
        add(table, label, values)
