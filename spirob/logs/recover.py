"""Brings back what a torn or damaged MCAP file still holds, as a whole file.

Every chunk whose checksum holds comes back with all its messages, every attachment whose checksum
holds, and all metadata; a chunk that was cut or changed is left out, and said so.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from mcap.records import Channel, Schema
from mcap.writer import CompressionType, Writer

from spirob.errors import DataError
from spirob.logs.atomic import replacing
from spirob.logs.records import read_bytes
from spirob.logs.schema import SCHEMAS
from spirob.logs.survey import Recovered, Survey
from spirob.logs.writer import CHUNK_BYTES


def recover(source: Path | str, target: Path | str) -> Recovered:
    """Write what `source` still holds to `target`, whole or not at all.

    Raises MissingLog; DataError where there is no MCAP file, nothing whole is left in it, or
    `target` exists.
    """
    if Path(target).exists():
        raise DataError(f"{target}: exists already and is left as it is")
    found = Survey(read_bytes(source))
    if not (found.places or found.attachments or found.metadata):
        raise DataError(f"{source}: no chunk, attachment or metadata in it is whole")
    with replacing(target) as temporary, temporary.open("wb") as file:
        done = _write(found, file)
    return done


def _write(found: Survey, file: BinaryIO) -> Recovered:
    writer = Writer(
        file,
        chunk_size=CHUNK_BYTES,
        compression=CompressionType.ZSTD,
        enable_data_crcs=True,
    )
    writer.start(found.profile, found.library)
    for one in found.metadata:
        writer.add_metadata(one.name, one.metadata)
    for a in found.attachments:
        writer.add_attachment(a.create_time, a.log_time, a.name, a.media_type, a.data)
    _declare_lost(found)
    numbers = dict(_register(found, writer))
    report, unknown = found.report, 0
    for channel, sequence, logged, published, data in found.messages():
        if channel in numbers:
            writer.add_message(numbers[channel], logged, data, published, sequence)
            report.messages += 1
        else:
            unknown += 1
    writer.finish()
    if unknown:
        found.note(f"{unknown} messages are lost: their channels are declared nowhere")
    report.metadata, report.attachments = len(found.metadata), len(found.attachments)
    return report


def _declare_lost(found: Survey) -> None:
    """The channels of a log of ours whose first chunk, which declares them, is gone."""
    if not found.library.startswith("spirob") or found.channels:
        return
    for number, (topic, (name, descriptor)) in enumerate(SCHEMAS.items(), 1):
        found.schemas[number] = Schema(id=number, data=descriptor, encoding="protobuf", name=name)
        found.channels[number] = Channel(
            id=number, topic=topic, message_encoding="protobuf", metadata={}, schema_id=number
        )
    found.note("the channels were declared in a lost chunk and taken from the writer's own list")


def _register(found: Survey, writer: Writer) -> Iterator[tuple[int, int]]:
    schemas = {0: 0}
    for channel in found.channels.values():
        schema = found.schemas.get(channel.schema_id)
        if schema is not None and schema.id not in schemas:
            schemas[schema.id] = writer.register_schema(schema.name, schema.encoding, schema.data)
        number = writer.register_channel(
            channel.topic,
            channel.message_encoding,
            schemas.get(channel.schema_id, 0),
            channel.metadata,
        )
        yield channel.id, number
