"""Logs that are one log under several names: a held-out log that was fitted vetoes nothing."""

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from spirob.errors import ConfigError


def each_once(
    logs: Sequence[tuple[str, Mapping[str, np.ndarray]]], compared: Sequence[str]
) -> None:
    """Raise ConfigError where the rows of one log are another's, or a stretch of them.

    logs      name and columns of each;  compared  the columns that say what the machine did: time
              may begin anew in a copy
    """
    rows = [(name, _rows(columns, compared)) for name, columns in logs]
    for one, other in combinations(rows, 2):
        (part, few), (whole, many) = (one, other) if len(one[1]) < len(other[1]) else (other, one)
        if few and few in many:
            said = "holds the rows of" if len(few) == len(many) else "is a part of"
            raise ConfigError(f"{part}: {said} {whole}; a log is fitted or held out, once")


def _rows(columns: Mapping[str, np.ndarray], compared: Sequence[str]) -> bytes:
    """The rows as bytes, none where a column is absent or nothing moves."""
    if any(name not in columns for name in compared):
        return b""
    table = np.column_stack([np.asarray(columns[name], float) for name in compared])
    return b"" if np.all(table == table[:1]) else table.tobytes()
