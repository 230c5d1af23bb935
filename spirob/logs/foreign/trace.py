"""Columns of a file and a mapping to a trace in SI units."""

from collections.abc import Mapping as Columns

import numpy as np

from spirob.errors import DataError, MissingChannel
from spirob.logs.foreign.agreement import check_names, check_rates
from spirob.logs.foreign.clock import increasing
from spirob.logs.foreign.mapping import Mapping
from spirob.trace import Trace
from spirob.units import UNITS

LOG_TIME = "log_time"  # column of nanoseconds that an MCAP file brings by itself


def trace_from(
    where: str, columns: Columns[str, np.ndarray], mapping: Mapping, notes: list[str]
) -> Trace:
    """The channels that a mapping names, in SI; `notes` gains a sentence for every repair.

    Raises MissingChannel, and DataError where time or units cannot be right.
    """
    check_names(where, mapping)
    stamps, factor = _stamps(where, columns, mapping)
    rows, time_ns = increasing(where, stamps, factor, notes)
    signals, units = {}, {}
    for channel, source in mapping.channels.items():
        values = _column(where, columns, source.key)
        if len(values) != len(stamps):
            raise DataError(
                f"{where}: column '{source.key}' has {len(values)} rows, time has {len(stamps)}"
            )
        unit = UNITS[source.unit]
        signals[channel] = source.sign * unit.factor * (values[rows] + unit.offset)
        units[channel] = unit.si
        bad = int(np.count_nonzero(~np.isfinite(signals[channel])))
        if bad == len(rows):
            raise DataError(f"{where}: column '{source.key}' holds no finite value")
        if bad:
            notes.append(f"{where}: column '{source.key}' holds {bad} values that are not finite")
    check_rates(where, time_ns, signals)
    meta = dict(mapping.meta) | {"imported_from": where, "notes": list(notes)}
    return Trace(mapping.name, time_ns, signals, units, meta)


def _stamps(
    where: str, columns: Columns[str, np.ndarray], mapping: Mapping
) -> tuple[np.ndarray, float]:
    if mapping.time.column:
        return _column(where, columns, mapping.time.column), UNITS[mapping.time.unit].factor
    if LOG_TIME not in columns:
        raise DataError(f"{where}: the mapping names no column for time")
    return columns[LOG_TIME], UNITS["ns"].factor


def _column(where: str, columns: Columns[str, np.ndarray], name: str) -> np.ndarray:
    if name not in columns:
        raise MissingChannel(where, name, list(columns)[:40])
    return columns[name]
