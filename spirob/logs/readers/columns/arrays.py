"""An array of any shape as columns with names."""

from collections.abc import Iterator

import numpy as np

MOST = 1000  # columns that one matrix may become


def spread(
    name: str, array: np.ndarray, label: str = "[{}]", first: int = 0
) -> Iterator[tuple[str, np.ndarray]]:
    """Columns (n,) of a vector, a matrix or an array with named fields; none of a single value.

    label, first  how a matrix counts its columns: `name[0]`, or MATLAB's `name(1)`
    The longer side of a matrix is time.
    """
    if array.dtype.names:
        for field in array.dtype.names:
            yield from spread(f"{name}.{field}" if name else field, array[field], label, first)
    elif array.ndim == 1 and array.size > 1:
        yield name, array
    elif array.ndim == 2 and array.size > 1:
        rows = array if array.shape[0] >= array.shape[1] else array.T
        if rows.shape[1] == 1:
            yield name, rows[:, 0]
            return
        for k in range(min(rows.shape[1], MOST)):
            yield name + label.format(k + first), rows[:, k]
