"""HDF5: vectors and matrices by their place, `log.current`, `data[0]`; MATLAB 7.3 is one kind.

Only what lies in the file itself is read: links are not followed, and a dataset whose numbers are
kept in another file is left out.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from spirob.logs.readers.columns import Asked, Table, spread

if TYPE_CHECKING:
    import h5py

KIND = "HDF5 file"
SUFFIXES = {".h5", ".hdf5", ".hdf"}
NEEDS = ("h5py",)

LARGEST = 2**28  # bytes of all datasets
DEEPEST = 6  # groups within groups
MOST = 5000  # datasets and groups
STRUCTURES = 100  # structures in an array of them, of MATLAB
OWN = "of MATLAB (a table, a timeseries); save struct('t', t, ...) instead"


def read(asked: Asked) -> Table:
    """Columns by their place."""
    return _read(asked, _Walk(matlab=False))


def read_matlab(asked: Asked) -> Table:
    """Variables of a MATLAB file of version 7.3, named as those of version 5."""
    return _read(asked, _Walk(matlab=True))


def _read(asked: Asked, walk: "_Walk") -> Table:
    import h5py

    from spirob.logs.readers.columns import add

    table = Table(asked.name)
    with h5py.File(asked.path, "r") as file:
        for name, dataset in walk.through(file, "", 0):
            walk.take(dataset, name)
            values = dataset[()]
            label, first = ("({})", 1) if walk.matlab else ("[{}]", 0)
            array = np.asarray(values.T if walk.matlab else values)
            for column, cells in spread(name, array, label, first):
                add(table, column, cells)
    table.text |= walk.told
    return table


def _holds_objects(kind: np.dtype) -> bool:
    """Whether named fields hold what is no number; a lone column may hold texts."""
    return any(kind[name].hasobject for name in kind.names or ())


class _Walk:
    """A way through the groups of a file, which counts what it finds."""

    def __init__(self, matlab: bool) -> None:
        self.matlab = matlab
        self.told: dict[str, str] = {}
        self._left, self._steps = LARGEST, MOST

    def take(self, dataset: "h5py.Dataset", name: str) -> None:
        """Count a dataset; raises ValueError where all together are too large."""
        self._left -= dataset.nbytes
        if self._left < 0:
            raise ValueError(f"it unpacks to more than {LARGEST >> 20} MiB, at '{name[:80]}'")

    def through(
        self, group: "h5py.Group", name: str, depth: int
    ) -> Iterator[tuple[str, "h5py.Dataset"]]:
        """Datasets of numbers or texts at and below a group."""
        import h5py

        for key in group:
            if not isinstance(group.get(key, getlink=True), h5py.HardLink):
                self.told[f"{name}{key}"] = "a link, which is not followed"
            elif not (self.matlab and key.startswith("#")):
                yield from self._inside(group[key], f"{name}{key}", depth)

    def _inside(self, item: Any, name: str, depth: int) -> Iterator[tuple[str, "h5py.Dataset"]]:
        import h5py

        self._steps -= 1
        if self._steps < 0 or depth > DEEPEST:
            raise ValueError(f"more than {MOST} parts, or {DEEPEST} groups within groups")
        own = item.attrs.get("MATLAB_class", b"") if self.matlab else b""
        if self.matlab and ("MATLAB_object_decode" in item.attrs or own == b"function_handle"):
            self.told[name] = f"objects {OWN}"
        elif isinstance(item, h5py.Group):
            counted = self._structures(item)
            if counted:
                yield from self._each(item, counted, name, depth)
            else:
                yield from self.through(item, f"{name}.", depth + 1)
        elif not isinstance(item, h5py.Dataset):
            return
        elif item.is_virtual or item.external:
            self.told[name] = "numbers that another file keeps, which is not read"
        elif own == b"char" or "MATLAB_empty" in item.attrs:
            return  # a text, or nothing
        elif not h5py.check_ref_dtype(item.dtype) and not _holds_objects(item.dtype):
            yield name, item

    def _structures(self, group: "h5py.Group") -> int:
        """Of how many structures of MATLAB's this group is an array; 0 where it is one alone."""
        import h5py

        sizes = set()
        for key in group:
            hard = isinstance(group.get(key, getlink=True), h5py.HardLink)
            item = group.get(key) if self.matlab and hard else None
            if not isinstance(item, h5py.Dataset) or not h5py.check_ref_dtype(item.dtype):
                return 0
            if "MATLAB_class" in item.attrs:  # a cell array in a structure
                return 0
            sizes.add(item.size)
        return min(sizes.pop(), STRUCTURES) if len(sizes) == 1 else 0

    def _each(
        self, group: "h5py.Group", count: int, name: str, depth: int
    ) -> Iterator[tuple[str, "h5py.Dataset"]]:
        for k in range(count):
            for key in group:
                reference = group[key][()].flat[k]
                if reference:
                    yield from self._inside(
                        group.file[reference], f"{name}({k + 1}).{key}", depth + 1
                    )
