"""What logs of messages share: bags of ROS, MCAP, CAN.

Topics of a log become columns `/topic.field`, on the time of the first topic that is wanted; a
field is a number in a message (`fields`): `joints[0].position`, `pose.position.x`.
"""

from array import array
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any, Protocol

import numpy as np

from spirob.errors import DataError, NothingLeft
from spirob.logs.readers.columns import LISTED, Asked, Table, example
from spirob.logs.readers.decoders import Decode, Encoding, decoder
from spirob.logs.readers.fields import Field, listed


@dataclass
class Series:
    """Numbers that came together, message by message.

    stamps  (m,) int64, nanoseconds
    values  column -> (m,)
    """

    name: str
    stamps: np.ndarray
    values: dict[str, np.ndarray]

    def ordered(self) -> "Series":
        """The same in the order of time."""
        if np.all(np.diff(self.stamps) >= 0):
            return self
        order = np.argsort(self.stamps, kind="stable")
        return Series(self.name, self.stamps[order], {n: v[order] for n, v in self.values.items()})


def put_together(table: Table, series: Sequence[Series], wanted: bool) -> None:
    """Columns of all series at the stamps of the first, the others at their latest; and `time`.

    `time` is in seconds since the first row.  Where all of it is `wanted`, rows before every series
    has begun are left out; else they are not a number, and the longest series is the first.  Raises
    DataError where none is left.
    """
    if not wanted:
        series = sorted(series, key=lambda one: -len(one.stamps))
    if not series:
        return
    base, *others = [one.ordered() for one in series]
    begin = max((one.stamps[0] for one in others if wanted), default=base.stamps[0])
    start = int(np.searchsorted(base.stamps, begin))
    stamps = base.stamps[start:]
    if not len(stamps):
        raise DataError(f"{table.name}: {base.name} ends before all other topics have begun")
    if start:
        table.say(f"{start} messages of {base.name} before the first of all others are left out.")
    for name, values in base.values.items():
        table.columns[name] = values[start:]
    for one in others:
        latest = np.searchsorted(one.stamps, stamps, side="right") - 1
        for name, values in one.values.items():
            table.columns[name] = np.where(latest < 0, np.nan, values[latest])
        table.say(f"{one.name} is held at its latest value at each message of {base.name}.")
    table.columns["time"] = (stamps - stamps[0]) / 1e9
    table.units["time"] = "s"


MOST = 1000  # fields that are read where none is named
DAMAGED = 0.05  # of a topic's messages may be broken, as such a share of rows may be out of place
SEARCHED = 20_000  # messages in which one of each topic is looked for


class Log(Protocol):
    """A log of messages.

    encodings  topic -> how its messages are written down
    """

    @property
    def encodings(self) -> Mapping[str, Encoding]: ...

    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, bytes]]:
        """Topic, log time [ns] and bytes of the messages of these topics."""
        ...


def read_topics(log: Log, asked: Asked, table: Table) -> Table:
    """Add to a table what is wanted of a log, or else all its numbers.

    Raises DataError where more than a few messages that are wanted are broken or none holds a
    number, NothingLeft where there is none.
    """
    decoders = _Decoders(asked.name, log.encodings)
    fields = _wanted(log.encodings, asked.wanted)
    if not fields and not asked.wanted:
        offered = _offered(log, decoders)
        if sum(map(len, offered.values())) > MOST:
            raise DataError(f"{asked.name}: more than {MOST} channels; name those that are wanted")
        fields = {
            topic: {name: Field(name[len(topic) :]) for name in names}
            for topic, names in offered.items()
        }
    series = [s for s in _series(log, decoders, fields, table) if len(s.stamps)]
    put_together(table, series, bool(asked.wanted))
    for places in fields.values():
        table.units |= {n: "s" for n, f in places.items() if f.is_time and n in table.columns}
    if not table.columns or any(name not in table.columns for name in asked.wanted):
        _tell_others(log, decoders, fields, table)
    return table


def _tell_others(
    log: Log, decoders: "_Decoders", fields: Mapping[str, Mapping[str, Field]], table: Table
) -> None:
    """Name what there is; where nothing of that was wanted, time is given none the less.

    Raises NothingLeft where there is no message at all, DataError where none holds a number.
    """
    found = _offered(log, decoders)
    if not found:
        raise NothingLeft(f"{table.name}: holds no message{_besides(table)}")
    offered = {topic: names for topic, names in found.items() if names}
    _tell_texts(log, decoders, fields, table)
    if not offered:
        held = ", ".join(f"'{name}' holds {text}, not numbers" for name, text in table.text.items())
        none = f"no message of {', '.join(found)} holds a number that can be read"
        raise DataError(f"{table.name}: {held or none}{_besides(table)}")
    table.others = [name for names in offered.values() for name in names]
    if not table.columns:
        topic = next(iter(offered))
        stamps = [logged for _, logged, _ in log.messages([topic])]
        put_together(table, [Series(topic, np.array(stamps, np.int64), {})], wanted=True)


def _tell_texts(
    log: Log, decoders: "_Decoders", fields: Mapping[str, Mapping[str, Field]], table: Table
) -> None:
    """What texts there are in place of the numbers that are wanted."""
    for topic, places in fields.items():
        left = {name: field for name, field in places.items() if name not in table.columns}
        for _, _, data in islice(log.messages([topic]) if left else (), SEARCHED):
            message = decoders.whole(topic, data)
            texts = {name: field.at(message) for name, field in left.items()}
            held = {name: text for name, text in texts.items() if isinstance(text, str)}
            table.text |= {name: f"text such as {example(text)}" for name, text in held.items()}
            if message is not None:
                break


def _besides(table: Table) -> str:
    """What is said of a log already, behind the reason why it cannot be used."""
    said = [s.removeprefix(f"{table.name}: ").removesuffix(".") for s in table.said[:LISTED]]
    return "".join(f"; {sentence}" for sentence in said)


class Broken(DataError):
    """A message that its decoder cannot read; others of its topic it may."""


class _Decoders:
    """Decoders of topics, made when they are needed."""

    def __init__(self, where: str, encodings: Mapping[str, Encoding]) -> None:
        self._where, self._encodings = where, encodings
        self._made: dict[str, Decode] = {}

    def __call__(self, topic: str, data: bytes) -> Any:
        if topic not in self._made:
            self._made[topic] = decoder(self._where, topic, self._encodings[topic])
        try:
            return self._made[topic](data)
        except Exception as error:  # code that a library makes of a definition raises anything
            said = " ".join(str(error).split())[:200] or type(error).__name__
            raise Broken(f"{self._where}: a message of {topic} is broken: {said}") from None

    def whole(self, topic: str, data: bytes) -> Any:
        """The message; None where it is broken."""
        try:
            return self(topic, data)
        except Broken:
            return None


def _wanted(topics: Collection[str], names: Collection[str]) -> dict[str, dict[str, Field]]:
    """The fields that are wanted of each topic, topics in the order in which they are named."""
    found: dict[str, dict[str, Field]] = {}
    for name in names:
        of = [t for t in topics if name == t or name.startswith((f"{t}.", f"{t}["))]
        if of:
            topic = max(of, key=len)
            found.setdefault(topic, {})[name] = Field(name[len(topic) :])
    return found


def _offered(log: Log, decoders: _Decoders) -> dict[str, list[str]]:
    """Names of all numbers in one message of each topic that can be decoded."""
    found: dict[str, list[str]] = {}
    left = set(log.encodings)
    for topic, _, data in islice(log.messages(left), SEARCHED):
        if topic not in left:
            continue
        found[topic] = []
        try:
            found[topic] = list(listed(decoders(topic, data), topic))
        except Broken:  # the next one may be whole
            continue
        except DataError:
            pass
        left.discard(topic)
        if not left:
            break
    return found


def _series(
    log: Log, decoders: _Decoders, fields: Mapping[str, Mapping[str, Field]], table: Table
) -> Iterator[Series]:
    stamps = {topic: array("q") for topic in fields}
    rows = {topic: array("d") for topic in fields}
    missed, whole, lost = (dict.fromkeys(fields, 0) for _ in range(3))
    broken: dict[str, str] = {}
    for topic, logged, data in log.messages(fields) if fields else ():
        try:
            message = decoders(topic, data)
        except Broken as error:
            lost[topic] += 1
            broken.setdefault(topic, str(error))
            continue
        whole[topic] += 1
        row = [field.of(message) for field in fields[topic].values()]
        if all(np.isnan(row)):
            missed[topic] += 1
            continue
        stamps[topic].append(logged)
        rows[topic].extend(row)
    for topic, places in fields.items():
        if lost[topic] > DAMAGED * (lost[topic] + whole[topic]):
            raise DataError(broken[topic])
        if lost[topic]:
            table.say(f"{lost[topic]} messages of {topic} are broken and left out.")
        values = np.frombuffer(rows[topic], float).reshape(-1, len(places))
        columns = {name: values[:, k] for k, name in enumerate(places)}
        columns = {n: v for n, v in columns.items() if not np.all(np.isnan(v))}
        if missed[topic] and columns:
            table.say(f"{missed[topic]} messages of {topic} without what is wanted are left out.")
        yield Series(topic, np.frombuffer(stamps[topic], np.int64), columns)
