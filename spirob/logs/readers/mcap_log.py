"""MCAP: a log of this project by its channels, `left.current`; any other by topic and field."""

import mmap
from collections.abc import Collection, Iterator

from spirob.logs.readers.columns import Asked, Table
from spirob.logs.readers.decoders import Encoding
from spirob.logs.readers.topics import read_topics

KIND = "MCAP file"
SUFFIXES = {".mcap"}


def read(asked: Asked) -> Table:
    """Channels, and `time` in seconds; a note for what is damaged or held."""
    from spirob.logs.messages import RAW_TOPIC
    from spirob.logs.reader import read_log

    log = McapLog(asked)
    topics = tuple(log.encodings)
    if RAW_TOPIC in topics and not any(name.startswith(topics) for name in asked.wanted):
        trace = read_log(asked.path)
        return Table(asked.name, {"time": trace.seconds, **trace.signals}, units={"time": "s"})
    table = Table(asked.name)
    for note in log.notes:
        table.say(f"{note}.")
    return read_topics(log, asked, table)


class McapLog:
    """An MCAP file of any topics; see `topics.table.Log`.

    notes  sentences about what is damaged
    Raises DataError where it is none, or too large.
    """

    def __init__(self, asked: Asked) -> None:
        from spirob.errors import DataError
        from spirob.logs.reader import MAGIC
        from spirob.logs.recovery import Survey

        with asked.path.open("rb") as file:
            begins = file.read(len(MAGIC)) == MAGIC
            raw = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) if begins else b""
        if not begins:
            raise DataError(f"{asked.name}: this is not an MCAP file")
        self._survey = Survey(raw)
        self.notes = self._survey.report.notes
        self._topics: dict[int, str] = {}
        self.encodings: dict[str, Encoding] = {}
        for channel in self._survey.channels.values():
            schema = self._survey.schemas.get(channel.schema_id)
            about = (schema.encoding, schema.name, schema.data) if schema else ()
            encoding = Encoding(channel.message_encoding, *about)
            if self.encodings.setdefault(channel.topic, encoding) == encoding:
                self._topics[channel.id] = channel.topic

    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, bytes]]:
        """Topic, log time [ns] and bytes of the messages of these topics."""
        chosen = {number: topic for number, topic in self._topics.items() if topic in topics}
        for number, _, logged, _, data in self._survey.messages():
            if number in chosen and logged < 2**63:
                yield chosen[number], logged, data
