"""What logs of messages share: bags of ROS, MCAP, CAN.

Topics of a log become columns `/topic.field`, on the time of the first topic that is wanted; a
field is a number in a message: `joints[0].position`, `pose.position.x`, `position[elbow]`.

A message is made of dicts or records (of ROS, of protobuf) and lists.  An index may be a word where
a list of names as long as the array stands beside it or above, as in ROS's JointState.  The index
of an array of one may be left out.  A stamp, of seconds and nanoseconds, is a number in seconds.
"""

import dataclasses
import re
from array import array
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from spirob.errors import DataError, NothingLeft
from spirob.logs.readers.columns import Asked, Table
from spirob.logs.readers.decoders import Decode, Encoding, decoder

_STEP = re.compile(r"\.?([^.\[\]]+)|\[([^\[\]]{1,100})\]")
STAMPS = [("sec", "nanosec"), ("secs", "nsecs"), ("sec", "nsec"), ("seconds", "nanos")]
LONGEST = 64  # elements of an array that are listed
DEEPEST = 12  # structures within structures


class Field:
    """The number at one place of every message of a topic."""

    def __init__(self, place: str) -> None:
        self.is_time = False
        self._steps: list[tuple[str, int | None]] | None = []
        self._first: int | None = None
        at = 0
        while at < len(place) and self._steps is not None:
            step = _STEP.match(place, at)
            if step is None or (step[1] or "").startswith("_"):
                self._steps = None
                return
            index = int(step[2]) if step[2] and step[2].isdecimal() else None
            self._steps.append((step[1], -1) if step[1] else (step[2], index))
            at = step.end()

    def of(self, message: Any) -> float:
        """The number; not a number where there is none.  Stamps count from the first."""
        above: list[Any] = []
        for name, index in self._steps or ():
            above.append(message)
            if index == -1:
                message = _member(message, name)
            else:
                message = _element(message, name, index, above)
        if self._steps is None or message is None:
            return np.nan
        if _is_list(message) and len(message) == 1:
            message = message[0]
        stamp = _stamp(message)
        if stamp is None:
            return _number(message)
        self.is_time = True
        self._first = stamp if self._first is None else self._first
        return (stamp - self._first) / 1e9


def listed(message: Any, place: str, above: Sequence[Any] = ()) -> Iterator[str]:
    """The places of all numbers in a message, each with `place` before it."""
    if len(above) > DEEPEST:
        return
    if _is_list(message):
        labels = _labels(len(message), above)
        if len(message) == 1:
            yield from listed(message[0], place, (*above, message))
        else:
            for k in range(min(len(message), LONGEST)):
                label = labels[k] if labels else k
                yield from listed(message[k], f"{place}[{label}]", (*above, message))
    elif _stamp(message) is not None or not np.isnan(_number(message, nan=0.0)):
        yield place
    else:
        for name, inner in _members(message).items():
            yield from listed(inner, f"{place}.{name}", (*above, message))


def _member(message: Any, name: str) -> Any:
    if isinstance(message, Mapping):
        return message.get(name)
    return getattr(message, name, None)


def _element(message: Any, name: str, index: int | None, above: Sequence[Any]) -> Any:
    if not _is_list(message):
        return message.get(name) if isinstance(message, Mapping) else None
    if index is None:
        labels = _labels(len(message), above)
        index = labels.index(name) if labels and name in labels else None
    return message[index] if index is not None and index < len(message) else None


def _members(message: Any) -> dict[str, Any]:
    if isinstance(message, Mapping):
        return {str(name): inner for name, inner in message.items()}
    if dataclasses.is_dataclass(message):
        return {f.name: getattr(message, f.name) for f in dataclasses.fields(message)}
    kind = getattr(message, "DESCRIPTOR", None)
    return {f.name: getattr(message, f.name) for f in kind.fields} if kind else {}


def _labels(count: int, above: Sequence[Any]) -> list[str] | None:
    """A list of `count` different names, the nearest one above."""
    for message in reversed(above):
        for inner in _members(message).values():
            if _is_list(inner) and len(inner) == count and all(isinstance(n, str) for n in inner):
                names = list(inner)
                if len(set(names)) == count:
                    return names
    return None


def _is_list(message: Any) -> bool:
    if isinstance(message, str | bytes | Mapping):
        return False
    return hasattr(message, "__getitem__") and hasattr(message, "__len__")


def _stamp(message: Any) -> int | None:
    """Nanoseconds of a stamp."""
    for seconds, nanos in STAMPS:
        whole, part = _member(message, seconds), _member(message, nanos)
        if isinstance(whole, int) and isinstance(part, int):
            return whole * 10**9 + part
    return None


def _number(message: Any, nan: float = np.nan) -> float:
    if not isinstance(message, int | float | np.number):
        return np.nan
    try:
        found = float(message)
    except OverflowError:
        return np.inf
    return nan if np.isnan(found) else found


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

    Raises DataError where a message that is wanted is broken, NothingLeft where there is none.
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
    if any(name not in table.columns for name in asked.wanted):
        _tell_others(log, decoders, table)
    return table


def _tell_others(log: Log, decoders: "_Decoders", table: Table) -> None:
    """Name what there is; where nothing of that was wanted, time is given none the less.

    Raises NothingLeft where there is no message at all.
    """
    found = _offered(log, decoders)
    if not found:
        raise NothingLeft(f"{table.name}: holds no message")
    offered = {topic: names for topic, names in found.items() if names}
    table.others = [name for names in offered.values() for name in names] or list(log.encodings)
    if not table.columns and offered:
        topic = next(iter(offered))
        stamps = [logged for _, logged, _ in log.messages([topic])]
        put_together(table, [Series(topic, np.array(stamps, np.int64), {})], wanted=True)


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
            raise DataError(f"{self._where}: a message of {topic} is broken: {said}") from None


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
    for searched, (topic, _, data) in enumerate(log.messages(left)):
        if topic not in found:
            left.discard(topic)
            try:
                found[topic] = list(listed(decoders(topic, data), topic))
            except DataError:
                found[topic] = []
        if not left or searched > SEARCHED:
            break
    return found


def _series(
    log: Log, decoders: _Decoders, fields: Mapping[str, Mapping[str, Field]], table: Table
) -> Iterator[Series]:
    stamps = {topic: array("q") for topic in fields}
    rows = {topic: array("d") for topic in fields}
    missed = dict.fromkeys(fields, 0)
    for topic, logged, data in log.messages(fields) if fields else ():
        message = decoders(topic, data)
        row = [field.of(message) for field in fields[topic].values()]
        if all(np.isnan(row)):
            missed[topic] += 1
            continue
        stamps[topic].append(logged)
        rows[topic].extend(row)
    for topic, places in fields.items():
        values = np.frombuffer(rows[topic], float).reshape(-1, len(places))
        columns = {name: values[:, k] for k, name in enumerate(places)}
        columns = {n: v for n, v in columns.items() if not np.all(np.isnan(v))}
        if missed[topic] and columns:
            table.say(f"{missed[topic]} messages of {topic} without what is wanted are left out.")
        yield Series(topic, np.frombuffer(stamps[topic], np.int64), columns)
