"""Several series, each with stamps of its own, on the time of the first."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spirob.errors import DataError
from spirob.logs.readers.columns.table import Table


@dataclass
class Series:
    """Numbers that came together, message by message.

    stamps  (m,) int64, nanoseconds
    values  column -> (m,)
    """

    name: str
    stamps: np.ndarray
    values: dict[str, np.ndarray]

    def ordered(self) -> "Series":
        """The same in the order of time."""
        if np.all(np.diff(self.stamps) >= 0):
            return self
        order = np.argsort(self.stamps, kind="stable")
        return Series(self.name, self.stamps[order], {n: v[order] for n, v in self.values.items()})


def put_together(table: Table, series: Sequence[Series], wanted: bool) -> None:
    """Columns of all series at the stamps of the first, the others at their latest; and `time`.

    `time` is in seconds since the first row.  Where all of it is `wanted`, rows before every series
    has begun are left out, else they are not a number.  Raises DataError where none is left.
    """
    base, *others = [one.ordered() for one in series]
    begin = max((one.stamps[0] for one in others if wanted), default=base.stamps[0])
    start = int(np.searchsorted(base.stamps, begin))
    stamps = base.stamps[start:]
    if not len(stamps):
        raise DataError(f"{table.name}: {base.name} ends before all other topics have begun")
    if start:
        table.say(f"{start} messages of {base.name} before the first of all others are left out.")
    for name, values in base.values.items():
        table.columns[name] = values[start:]
    for one in others:
        latest = np.searchsorted(one.stamps, stamps, side="right") - 1
        for name, values in one.values.items():
            table.columns[name] = np.where(latest < 0, np.nan, values[latest])
        table.say(f"{one.name} is held at its latest value at each message of {base.name}.")
    table.columns["time"] = (stamps - stamps[0]) / 1e9
    table.units["time"] = "s"
