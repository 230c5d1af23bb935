"""Frames of a CAN bus, `candump` or what python-can reads, decoded by a DBC file.

Columns are `message.signal`, and `signal` where only one message has it; `time` is that of the
first message that is wanted.
"""

import logging
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from spirob.errors import DataError, NothingLeft
from spirob.logs.readers.columns import Asked, Table, printable
from spirob.logs.readers.topics import Series, put_together

if TYPE_CHECKING:
    from cantools.database.can import Message

KIND = "CAN log"
SUFFIXES = {".log", ".asc", ".blf", ".trc"}
BEGINS = re.compile(rb"\s*\(\d+\.\d+\)\s+\S+\s+[0-9A-Fa-f]+(#|\s+\[)")
NEEDS = ("can", "cantools")

LARGEST = 2**22  # bytes of a DBC file
LATEST = 2**63 - 1  # ns
AGAIN = 10**9  # ns, by which a clock that starts again falls back, as no order of messages does
FRAME = re.compile(  # candump -L, or candump -t a as it is seen
    r"\s*\((\d+)\.(\d+)\)\s+(\S+)\s+([0-9A-Fa-f]{3,8})"
    r"(?:#([0-9A-Fa-f]*)|##[0-9A-Fa-f]([0-9A-Fa-f]*)|\s+\[\d+\]((?:\s+[0-9A-Fa-f]{2})*))"
    r"(?:\s+[RT]|\s+'.*)?\s*"
)
SYNTAX = re.compile(r"Invalid syntax at line \d+, column \d+")  # behind it stands the line itself
Key = tuple[int, bool]  # identifier, whether it is one of 29 bits


class Frame(NamedTuple):
    """One data frame; `stamp` in nanoseconds."""

    stamp: int
    bus: str
    key: Key
    data: bytes


def read(asked: Asked) -> Table:
    """Signals of the messages in the log that the DBC file knows."""
    if asked.dbc is None:
        raise DataError(
            f"{asked.name}: a CAN log needs the DBC file that says what its frames mean; "
            "give `dbc:` in the description, or --dbc FILE to `spirob import`"
        )
    table, messages = Table(asked.name), _messages(asked.dbc)
    names = {k: [f"{m.name}.{s.name}" for s in m.signals] for k, m in messages.items()}
    chosen = [k for w in asked.wanted for k in names if any(_is(w, n) for n in names[k])]
    chosen = list(dict.fromkeys(chosen)) or list(names)
    kept, met = _kept(_one_clock(_frames(asked.path, table), table), set(chosen), table)
    if not met:
        raise NothingLeft(f"{asked.name}: holds no frame")
    known = [key for key in names if key in met]
    if not known:
        ids = ", ".join(f"{number:X}" for number, _ in sorted(met)[:20])
        raise DataError(f"{asked.name}: the DBC file knows none of its frames; identifiers: {ids}")
    series = [_decoded(messages[key], kept[key]) for key in chosen if key in kept]
    put_together(table, series, bool(asked.wanted))
    _short(table)
    listed = [name for key in known for name in names[key]]
    table.others = [name for name in listed if name not in table.columns]
    return table


def _messages(path: Path) -> "dict[Key, Message]":
    import cantools
    from cantools.database import Database

    logging.getLogger("cantools").setLevel(logging.ERROR)  # it tells every message given twice
    where = printable(str(path))
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
    except OSError as error:
        raise DataError(f"{where}: the DBC file cannot be read: {error.strerror}") from None
    if len(content) > LARGEST:
        raise DataError(f"{where}: more than {LARGEST >> 20} MiB are no DBC file")
    try:
        text = content.decode("cp1252", "replace")
        base = cantools.database.load_string(text, database_format="dbc", strict=False)
        assert isinstance(base, Database)
    except Exception as error:  # a text may be anything, and so is what the parser raises
        place = SYNTAX.search(str(error))
        said = place[0].lower() if place else " ".join(str(error).split())[:200]
        raise DataError(f"{where}: is no DBC file: {said}") from None
    return {(m.frame_id, m.is_extended_frame): m for m in base.messages if m.signals}


def _is(wanted: str, name: str) -> bool:
    return name == wanted or name.endswith(f".{wanted}")


def _frames(path: Path, table: Table) -> Iterator[Frame]:
    with path.open("rb") as file:
        head = file.read(512)
    if BEGINS.match(head) or path.suffix.lower() not in SUFFIXES - {".log"}:
        yield from _of_text(path, table)
    else:
        yield from _of_library(path, table)


def _one_clock(frames: Iterator[Frame], table: Table) -> Iterator[Frame]:
    """The frames, a stretch whose clock starts again behind the one before it."""
    latest, later, again = 0, 0, 0
    for frame in frames:
        if frame.stamp + later < latest - AGAIN:
            later, again = latest + AGAIN - frame.stamp, again + 1
        stamp = frame.stamp + later
        if stamp <= LATEST:
            latest = max(latest, stamp)
            yield frame._replace(stamp=stamp)
    if again:
        table.say(f"its clock starts again {again} times; put one behind the other.")


def _of_text(path: Path, table: Table) -> Iterator[Frame]:
    read, broken = 0, 0
    with path.open(encoding="ascii", errors="replace") as file:
        for line in iter(lambda: file.readline(1000), ""):
            found = FRAME.fullmatch(line)
            if found is None:
                broken += bool(line.strip())
                continue
            seconds, part, bus, number, *data = found.groups()
            stamp = int(seconds) * 10**9 + int(part[:9].ljust(9, "0"))
            if stamp > LATEST:
                broken += 1
                continue
            read += 1
            key = int(number, 16) & 0x1FFFFFFF, len(number) > 3
            digits = "".join(next((d for d in data if d is not None), "").split())
            yield Frame(stamp, bus, key, bytes.fromhex(digits[: len(digits) // 2 * 2]))
    if not read:
        raise DataError(f"{table.name}: no line is a frame as candump writes it")
    if broken:
        table.say(f"{broken} lines that are no data frame are left out.")


def _of_library(path: Path, table: Table) -> Iterator[Frame]:
    import can

    with can.LogReader(path) as reader:
        torn = path.stat().st_size < getattr(reader, "file_size", 0)  # as the head of a .blf says
        if torn:
            table.say("the file breaks off; the frames before are used.")
        try:
            for frame in reader:
                if frame.is_error_frame or frame.is_remote_frame:
                    continue
                key = frame.arbitration_id, frame.is_extended_id
                stamp = round(frame.timestamp * 1e9)
                yield Frame(stamp, str(frame.channel), key, bytes(frame.data))
        except Exception:  # what the library makes of the torn end may be anything
            if not torn:
                raise


def _kept(
    frames: Iterable[Frame], chosen: set[Key], table: Table
) -> tuple[dict[Key, list[Frame]], set[Key]]:
    """Frames of the messages that are chosen, each from one bus, and the identifiers there are."""
    met: set[Key] = set()
    buses: dict[Key, str] = {}
    kept: dict[Key, list[Frame]] = {}
    left = 0
    for frame in frames:
        met.add(frame.key)
        if frame.key not in chosen:
            continue
        if buses.setdefault(frame.key, frame.bus) == frame.bus:
            kept.setdefault(frame.key, []).append(frame)
        else:
            left += 1
    if left:
        table.say(f"{left} frames of a second bus with the same identifiers are left out.")
    return kept, met


def _decoded(message: "Message", frames: list[Frame]) -> Series:
    rows: dict[str, list[float]] = {s.name: [] for s in message.signals}
    in_turn = {s.name for s in message.signals if s.multiplexer_ids}  # held until it comes again
    for frame in frames:
        found: Any = message.decode(
            frame.data, decode_choices=False, allow_truncated=True, allow_excess=True
        )
        for name, column in rows.items():
            column.append(found.get(name, column[-1] if name in in_turn and column else np.nan))
    stamps = np.array([frame.stamp for frame in frames], np.int64)
    values = {f"{message.name}.{name}": np.array(column, float) for name, column in rows.items()}
    there = {name: column for name, column in values.items() if not np.all(np.isnan(column))}
    return Series(message.name, stamps, there)


def _short(table: Table) -> None:
    short = Counter(name.partition(".")[2] for name in table.columns)
    for name in list(table.columns):
        signal = name.partition(".")[2]
        if signal and short[signal] == 1 and signal not in table.columns:
            table.columns[signal] = table.columns[name]
