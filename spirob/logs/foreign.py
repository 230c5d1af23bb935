"""Measurements from elsewhere, brought into a `Trace` by a mapping file.

The mapping says which column is which channel in what unit:

    name: lab_run_7
    time: {column: t, unit: ms}
    channels:
      left.current: {column: "I left [mA]", unit: mA}
      left.displacement: {column: x1, unit: mm, sign: -1}
      left.velocity: {topic: /joints, field: "joints[0].velocity", unit: m/s}
    meta: {role: train, rig: bench}

`sign: -1` where the file counts the other way round: positive current and length wind in.

The trace is in SI units, on strictly increasing nanoseconds; what is repaired is said.  Rows of a
stamp that many share are spread evenly; of a few that share theirs the last is kept.  A clock that
starts again is an error: an import is one trial.
"""

import re
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, StringConstraints, ValidationError

from spirob import files, plain_yaml
from spirob.errors import ConfigError, DataError
from spirob.logs.readers import Table
from spirob.logs.stamps import even_clock, ordered
from spirob.logs.trace import Trace
from spirob.units import UNITS, unit

LARGEST = 2**18  # bytes of a mapping file
SI = {  # of channels that the program knows, after the motor's name
    "current": "A",
    "current_filtered": "A",
    "command": "A",
    "displacement": "m",
    "velocity": "m/s",
    "tension": "N",
    "temperature": "degC",
}
Text = Annotated[str, StringConstraints(min_length=1, max_length=200)]


class Strict(BaseModel):
    """No key that is not declared."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, strict=True)


class Column(Strict):
    """Where one channel comes from: a `column`, or a `field` of a `topic` in a log of messages."""

    column: Text = ""
    topic: Text = ""
    field: Text = ""
    unit: Text
    sign: Literal[1, -1] = 1

    @property
    def key(self) -> str:
        """Its name among the columns that were read."""
        return self.column or f"{self.topic}.{self.field}"


class Time(Strict):
    """Where time comes from; without a column, the log time of a log of messages."""

    column: Text = ""
    unit: Text = "s"


class Mapping(Strict):
    """A whole mapping file."""

    name: Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.\-]{0,99}$")]
    time: Time = Time()
    channels: dict[Text, Column] = Field(min_length=1, max_length=500)
    meta: dict[Text, Text | int | float | bool] = {}

    @property
    def columns(self) -> list[str]:
        """Names of all columns that are used."""
        keys = [column.key for column in self.channels.values()]
        return [self.time.column, *keys] if self.time.column else keys


def read_mapping(path: Path | str) -> Mapping:
    """Read and check a mapping file.

    Raises MissingLog, DataError (no file to read) and ConfigError naming the file and the key.
    """
    content = files.content(path, "mapping file", LARGEST)
    return mapping_from(plain_yaml.read(content, str(path)), str(path))


def mapping_from(plain: object, where: str) -> Mapping:
    """A mapping from plain data; raises ConfigError naming `where` and the key."""
    try:
        mapping = Mapping.model_validate(plain)
    except (ValidationError, RecursionError) as error:
        raise ConfigError(f"{where}: {_first(error)}") from None
    unit(mapping.time.unit, f"{where}: time")
    if unit(mapping.time.unit, where).si != "s":
        raise ConfigError(f"{where}: time: unit '{mapping.time.unit}' is no unit of time")
    for channel, column in mapping.channels.items():
        place = f"{where}: channels.{channel}"
        if bool(column.column) == bool(column.topic and column.field):
            raise ConfigError(f"{place} needs either 'column', or 'topic' and 'field'")
        si = unit(column.unit, place).si
        wanted = SI.get(channel.rsplit(".", 1)[-1], si)
        if si != wanted:
            raise ConfigError(f"{place}: unit '{column.unit}' is not of the kind of {wanted}")
    return mapping


def _first(error: ValidationError | RecursionError) -> str:
    if isinstance(error, RecursionError):
        return "is nested too deeply"
    first = error.errors(include_input=False, include_url=False)[0]
    key = ".".join(str(part) for part in first["loc"]) or "the file"
    return f"key '{key[:200]}': {first['msg']}"


_BRACKETED = re.compile(r"[\[(]\s*([^\[\]()\d][^\[\]()]{0,11}?)\s*[\])]\s*$")
_RATES = {"displacement": "velocity"}
ALIKE = 0.9  # correlation above which two channels are one motion
FAR = 1.5  # times by which a rate may differ from its channel's own


def check_names(where: str, mapping: Mapping) -> None:
    """A column named 'I [mA]' is not in A; raises DataError."""
    named = {channel: (c.column, c.unit) for channel, c in mapping.channels.items()}
    named["time"] = mapping.time.column, mapping.time.unit
    for channel, (column, given) in named.items():
        found = _BRACKETED.search(column)
        if found and found[1] in UNITS and UNITS[found[1]] != UNITS[given]:
            raise DataError(
                f"{where}: column '{column}' says {found[1]}, the mapping of {channel} says {given}"
            )


def check_rates(where: str, time_ns: np.ndarray, signals: dict[str, np.ndarray]) -> None:
    """A velocity must be the rate of its displacement; raises DataError with the factor."""
    for channel, values in signals.items():
        motor, _, kind = channel.rpartition(".")
        other = f"{motor}.{_RATES.get(kind, '')}"
        if other not in signals or len(values) < 10:
            continue
        rate = np.gradient(values, time_ns * 1e-9)
        told = signals[other]
        good = np.isfinite(rate) & np.isfinite(told)
        rate, told = _smooth(rate[good]), _smooth(told[good])
        if len(rate) < 10 or rate.std() == 0 or told.std() == 0:
            continue
        alike = float(np.corrcoef(rate, told)[0, 1])
        factor = float(np.dot(rate, told) / np.dot(rate, rate))
        if abs(alike) > ALIKE and not 1 / FAR < factor < FAR:
            raise DataError(
                f"{where}: {other} is {factor:.4g} times the rate of {channel}; check unit and sign"
            )


def _smooth(values: np.ndarray) -> np.ndarray:
    width = max(1, len(values) // 200)
    return np.convolve(values, np.ones(width) / width, "valid")


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
