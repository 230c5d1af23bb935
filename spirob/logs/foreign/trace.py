"""A table and a mapping to a trace in SI units, on strictly increasing nanoseconds.

Stamps of a file to strictly increasing nanoseconds; what is repaired is said.

Rows of a stamp that many share are spread evenly; of a few that share theirs the last is kept.  A
clock that starts again is an error: an import is one trial.
"""

import numpy as np

from spirob.errors import DataError
from spirob.logs.foreign.mapping import Mapping, check_names, check_rates
from spirob.logs.readers import Table
from spirob.logs.stamps import even_clock, ordered
from spirob.trace import Trace
from spirob.units import UNITS

LONGEST = 9.2e18  # nanoseconds that an int64 holds
GAP = 5  # median periods that are told as a gap
COARSE = 0.05  # of the rows share their stamp: the clock is coarser than the samples


def increasing(
    where: str, stamps: np.ndarray, factor: float, notes: list[str]
) -> tuple[np.ndarray, np.ndarray]:
    """Rows to use, in order, and their time [ns]; `factor` is seconds a unit of the stamps.

    Raises DataError where time runs backwards, starts again or is no time.
    """
    found = ordered(where, stamps, factor, notes)
    rows, values = found.rows, found.stamps
    if len(found.begins) > 1:
        again = rows[found.begins[1]] + 1
        raise DataError(f"{where}: the clock starts again in row {again}; cut the file there")
    scale = factor * 1e9
    if float(np.abs(values).max()) * scale > LONGEST:
        raise DataError(f"{where}: time reaches beyond what nanoseconds can hold; check its unit")
    whole = np.rint(values * scale).astype(np.int64)  # since 1970 a float64 is good to 256 ns
    if np.mean(np.diff(whole) == 0) > COARSE and len(np.unique(whole)) > 2:
        clock = even_clock(1e-9 * (whole - whole[0]))
        even = clock.given if clock.even is None else clock.even
        whole = whole[0] + np.rint(1e9 * (even - even[0])).astype(np.int64)
        notes.append(
            f"{where}: the clock is coarser than the samples, {clock.shared:.3g} rows to a stamp; "
            f"rows were spread evenly, {clock.period:.4g} s apart."
        )
    keep = np.concatenate([np.diff(whole) > 0, [True]])
    if not keep.all():
        count = int(np.count_nonzero(~keep))
        notes.append(f"{where}: {count} rows left out that share their time with the next.")
        rows, whole = rows[keep], whole[keep]
    _tell_gaps(where, whole, notes)
    return rows, whole


def _tell_gaps(where: str, time_ns: np.ndarray, notes: list[str]) -> None:
    step = np.diff(time_ns)
    if len(step) < 2:
        return
    gaps = step > GAP * np.median(step)
    if gaps.any():
        notes.append(
            f"{where}: {int(gaps.sum())} gaps in time, the longest {1e-9 * step.max():.3g} s; kept."
        )


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
