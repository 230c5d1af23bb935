"""The mapping file: which column is which channel in what unit, and units that cannot be right.

name: lab_run_7
    time: {column: t, unit: ms}
    channels:
      left.current: {column: "I left [mA]", unit: mA}
      left.displacement: {column: x1, unit: mm, sign: -1}
      left.velocity: {topic: /joints, field: "joints[0].velocity", unit: m/s}
    meta: {role: train, rig: bench}

`sign: -1` where the file counts the other way round: positive current and length wind in.
"""

import re
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, StringConstraints, ValidationError

from spirob import given_file, plain_yaml
from spirob.errors import ConfigError, DataError
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
    content = given_file.content(path, "mapping file", LARGEST)
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
