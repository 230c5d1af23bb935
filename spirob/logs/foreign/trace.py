"""A table and a mapping to a trace in SI units."""

import numpy as np

from spirob.errors import DataError
from spirob.logs.foreign.agreement import check_names, check_rates
from spirob.logs.foreign.clock import increasing
from spirob.logs.foreign.mapping import Mapping
from spirob.logs.readers import Table
from spirob.trace import Trace
from spirob.units import UNITS

LOG_TIME = "time"  # which a log of messages brings by itself


def trace_from(table: Table, mapping: Mapping) -> Trace:
    """The channels that a mapping names, in SI; `table.said` gains a sentence for every repair.

    Raises MissingChannel, and DataError where time or units cannot be right.
    """
    where, notes = table.name, table.said
    check_names(where, mapping)
    stamps, factor = _stamps(table, mapping)
    rows, time_ns = increasing(where, stamps, factor, notes)
    signals, units = {}, {}
    for channel, source in mapping.channels.items():
        values = table.column(source.key)
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


def _stamps(table: Table, mapping: Mapping) -> tuple[np.ndarray, float]:
    """Time as it stands in the file, and its unit in seconds."""
    name, unit = mapping.time.column, mapping.time.unit
    if not name:
        if table.columns and table.units.get(LOG_TIME) != "s":
            raise DataError(f"{table.name}: the mapping names no column for time")
        for source in mapping.channels.values():  # what is missing is told before time is
            table.column(source.key)
        name = LOG_TIME
    return table.column(name), UNITS[table.units.get(name, unit)].factor
