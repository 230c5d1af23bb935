"""A bag of ROS 2: a folder with .db3 or .mcap files, or one .db3, by topic and field."""

import re
import sqlite3
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from urllib.parse import quote_from_bytes

from spirob.errors import DataError
from spirob.logs.readers.columns import Asked, Table, printable
from spirob.logs.readers.decoders import Encoding
from spirob.logs.readers.mcap_log import McapLog
from spirob.logs.readers.topics import Log, read_topics

KIND = "bag of ROS 2"
SUFFIXES = {".db3"}
FOLDER = re.compile(r"\.(db3|mcap)(\.zstd)?$|^metadata\.yaml$")
NEEDS = ("rosbags.typesys",)

PACKED = b"\x28\xb5\x2f\xfd"  # with which a message begins that is compressed by itself
LARGEST = 2**26  # bytes of one message


def read(asked: Asked) -> Table:
    """Fields of topics, and `time` in seconds."""
    table = Table(asked.name)
    if not asked.path.is_dir():
        return read_topics(Database(asked.path), asked, table)
    files = sorted(p for p in asked.path.iterdir() if FOLDER.search(p.name))
    logs: list[Log] = []
    for path in files:
        if path.suffix == ".zstd":
            raise DataError(f"{asked.name}: unpack its files first, zstd -d {printable(path.name)}")
        if path.suffix == ".db3":
            logs.append(Database(path))
        elif path.suffix == ".mcap":
            part = McapLog(Asked(path))
            logs.append(part)
            for note in part.notes:
                table.say(f"{printable(path.name)}: {note}.")
    if not logs:
        raise DataError(f"{asked.name}: is a folder without .db3 or .mcap files")
    return read_topics(Files(logs), asked, table)


class Files:
    """Several files of one bag; see `topics.table.Log`."""

    def __init__(self, logs: Sequence[Log]) -> None:
        self._logs = logs
        self.encodings: dict[str, Encoding] = {}
        for log in logs:
            self.encodings = {**log.encodings, **self.encodings}

    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, bytes]]:
        """Topic, log time [ns] and bytes of the messages of these topics."""
        for log in self._logs:
            yield from log.messages(topics)


class Database:
    """A .db3 file; see `topics.table.Log`."""

    def __init__(self, path: Path) -> None:
        uri = f"file:{quote_from_bytes(bytes(path.resolve()))}?mode=ro&immutable=1"
        self._base = sqlite3.connect(uri, uri=True)
        tables = {name for (name,) in self._base.execute("SELECT name FROM sqlite_master")}
        if not {"topics", "messages"} <= tables:
            raise ValueError("it has no tables of topics and messages")
        definitions: dict[str, tuple[str, str]] = {}
        if "message_definitions" in tables:
            for kind, language, text in self._base.execute(
                "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
            ):
                definitions[str(kind)] = str(language), str(text)
        self._numbers: dict[int, str] = {}
        self.encodings: dict[str, Encoding] = {}
        for number, name, kind, encoding in self._base.execute(
            "SELECT id, name, type, serialization_format FROM topics"
        ):
            language, text = definitions.get(str(kind), ("", ""))
            self._numbers[number] = str(name)
            self.encodings[str(name)] = Encoding(str(encoding), language, str(kind), text.encode())

    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, bytes]]:
        """Topic, log time [ns] and bytes of the messages of these topics."""
        chosen = [number for number, name in self._numbers.items() if name in topics]
        places = ",".join("?" * len(chosen))
        for number, logged, data in self._base.execute(
            f"SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN ({places}) "
            "ORDER BY timestamp",
            chosen,
        ):
            yield self._numbers[number], int(logged), _unpacked(bytes(data))


def _unpacked(data: bytes) -> bytes:
    if not data.startswith(PACKED):
        return data
    import zstandard

    return zstandard.ZstdDecompressor().decompress(data, max_output_size=LARGEST)
