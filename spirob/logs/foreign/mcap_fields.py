"""Fields of messages in an MCAP file of others, encoded as JSON or protobuf, as columns.

The first channel's topic gives the time base; at each of its messages the other topics hold the
latest value before.
"""

import json
import re
from array import array
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mcap.records import Schema

from spirob.errors import DataError, MissingChannel
from spirob.logs.foreign.mapping import Mapping
from spirob.logs.foreign.trace import LOG_TIME
from spirob.logs.records import read_bytes
from spirob.logs.survey import Survey

_STEP = re.compile(r"([^.\[\]]+)|\[(\d{1,6})\]")
Decode = Callable[[bytes], Any]


def read_fields(path: Path | str, mapping: Mapping, notes: list[str]) -> dict[str, np.ndarray]:
    """The columns that a mapping names, and `log_time` [ns]; a note for what is damaged or held.

    Raises MissingLog, MissingChannel, and DataError where the file cannot be used.
    """
    survey = Survey(read_bytes(path))
    notes += [f"{path}: {note}" for note in survey.report.notes]
    wanted: dict[str, list[str]] = {}
    for column in mapping.channels.values():
        if column.topic:
            wanted.setdefault(column.topic, []).append(column.field)
    if not wanted:
        raise DataError(f"{path}: the mapping names no topic")
    series = _series(str(path), survey, wanted)
    base = series[next(iter(wanted))][0]
    columns = {LOG_TIME: base.astype(float) if len(base) else base}
    for topic, (stamps, rows) in series.items():
        if stamps is not base:
            notes.append(f"{path}: {topic} is held at its latest value")
        order = np.argsort(stamps, kind="stable")
        latest = np.searchsorted(stamps[order], base, side="right") - 1
        table = rows.reshape(len(stamps), len(wanted[topic]))[order]
        held = np.where(latest[:, None] >= 0, table[np.maximum(latest, 0)], np.nan)
        for k, field in enumerate(wanted[topic]):
            columns[f"{topic}:{field}"] = table[:, k] if stamps is base else held[:, k]
    return columns


def _series(
    where: str, survey: Survey, wanted: dict[str, list[str]]
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    topics = {channel.id: channel for channel in survey.channels.values()}
    decoders: dict[int, Decode] = {}
    paths = {topic: [_path(where, field) for field in of] for topic, of in wanted.items()}
    stamps = {topic: array("Q") for topic in wanted}
    rows = {topic: array("d") for topic in wanted}
    for number, _, logged, _, data in survey.messages():
        channel = topics.get(number)
        if channel is None or channel.topic not in wanted:
            continue
        if number not in decoders:
            schema = survey.schemas.get(channel.schema_id)
            decoders[number] = _decoder(where, channel.topic, channel.message_encoding, schema)
        try:
            message = decoders[number](data)
        except (ValueError, RecursionError, TypeError) as error:
            raise DataError(f"{where}: a message of {channel.topic} is broken: {error}") from None
        stamps[channel.topic].append(logged)
        rows[channel.topic].extend(_value(message, path) for path in paths[channel.topic])
    for topic, of in stamps.items():
        if not of:
            raise MissingChannel(where, topic, sorted({c.topic for c in topics.values()})[:40])
    return {
        topic: (np.frombuffer(of, np.uint64).astype(float), np.frombuffer(rows[topic], float))
        for topic, of in stamps.items()
    }


def _decoder(where: str, topic: str, encoding: str, schema: Schema | None) -> Decode:
    if encoding == "json":
        return json.loads
    if encoding == "protobuf" and schema is not None:
        return _protobuf(where, schema)
    raise DataError(f"{where}: {topic} is encoded as '{encoding}'; read are json and protobuf")


def _protobuf(where: str, schema: Schema) -> Decode:
    try:
        from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
        from google.protobuf.message import DecodeError
    except ImportError:
        raise DataError(f"{where}: install 'protobuf' to read messages of {schema.name}") from None
    try:
        files = descriptor_pb2.FileDescriptorSet.FromString(schema.data)
        pool = descriptor_pool.DescriptorPool()
        for file in files.file:
            pool.Add(file)
        kind = message_factory.GetMessageClass(pool.FindMessageTypeByName(schema.name))
    except (DecodeError, KeyError, TypeError, ValueError) as error:
        raise DataError(f"{where}: the schema of {schema.name} is broken: {error}") from None

    def decode(data: bytes) -> Any:
        try:
            return kind.FromString(data)
        except DecodeError as error:
            raise ValueError(str(error)) from None

    return decode


def _path(where: str, field: str) -> list[str | int]:
    steps = [name or int(index) for name, index in _STEP.findall(field)]
    written = "".join(f"[{s}]" if isinstance(s, int) else f".{s}" for s in steps)
    if written.lstrip(".") != field or any(str(step).startswith("_") for step in steps):
        raise DataError(f"{where}: '{field}' is no field; write it as joints[0].position")
    return steps


def _value(message: Any, path: Sequence[str | int]) -> float:
    """The number at a path; not a number where there is none."""
    for step in path:
        if isinstance(step, str) and not isinstance(message, dict):
            message = getattr(message, step, None)
            continue
        try:
            message = message[step]
        except (TypeError, IndexError, KeyError):
            return np.nan
    try:
        return float(message) if isinstance(message, int | float) else np.nan
    except OverflowError:
        return np.nan
