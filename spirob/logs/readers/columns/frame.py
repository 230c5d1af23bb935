"""A table of pandas as a log."""

import pandas as pd

from spirob.logs.readers.columns.sorting import add
from spirob.logs.readers.columns.table import Table, printable


def from_frame(frame: pd.DataFrame, name: str) -> Table:
    """The columns of a frame, and its index where that has a name, as a table."""
    table = Table(printable(name))
    whole = frame.reset_index() if frame.index.name is not None else frame
    for k, column in enumerate(whole.columns):
        if str(column) not in table.columns:
            add(table, str(column), whole.iloc[:, k].to_numpy())
    return table
