"""A bag of ROS 1, by topic and field."""

from collections.abc import Collection, Iterator
from typing import TYPE_CHECKING

from spirob.logs.readers.columns import Asked, Table
from spirob.logs.readers.decoders import Encoding
from spirob.logs.readers.topics import read_topics

if TYPE_CHECKING:
    from rosbags.rosbag1 import Reader

KIND = "bag of ROS 1"
SUFFIXES = {".bag"}
NEEDS = ("rosbags.rosbag1", "rosbags.typesys")


def read(asked: Asked) -> Table:
    """Fields of topics, and `time` in seconds."""
    from rosbags.rosbag1 import Reader

    with Reader(asked.path) as reader:
        return read_topics(Bag(reader), asked, Table(asked.name))


class Bag:
    """An open bag; see `topics.table.Log`."""

    def __init__(self, reader: "Reader") -> None:
        self._reader = reader
        self.encodings = {
            c.topic: Encoding("ros1", "ros1msg", c.msgtype, c.msgdef.data.encode())
            for c in reader.connections
        }

    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, bytes]]:
        """Topic, log time [ns] and bytes of the messages of these topics."""
        chosen = [c for c in self._reader.connections if c.topic in topics]
        if chosen:
            for connection, logged, data in self._reader.messages(chosen):
                yield connection.topic, logged, data
