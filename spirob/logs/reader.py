"""An MCAP log as a `Trace` in SI units, derived from the raw frames.

Row k stands for cycle k, t_k = t_0 + k ms.  Measured channels are the latest feedback received
before the command of cycle k went out, the command and references are what was sent then: the
state at t_k and the input held from t_k to t_(k+1).  Where a cycle or a frame is missing the value
before it holds, and `meta["frames"]` counts it.

The records of the file are read with messages in bulk; no length and no checksum is trusted unseen.
"""

import os
import struct
import threading
import zlib
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import yaml
import zstandard
from lz4.frame import LZ4FrameDecompressor
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Chunk, DataEnd, Metadata

from spirob.can.drive import Drive, translated
from spirob.control import CURRENT, DISPLACEMENT, FORCE, VELOCITY
from spirob.errors import ConfigError, DataError, MissingChannel, MissingLog, TooShort
from spirob.logs.cycles import Cycles, Transmission
from spirob.logs.messages import (
    ABOUT,
    COMMAND_TOPIC,
    DBC_FILE,
    DRIVE_FILE,
    LOOP,
    RAW_TOPIC,
    STOPPED,
    TRIAL_FILE,
    unpack_commands,
    unpack_frames,
)
from spirob.logs.payloads import CHUNK_LIMIT, RECORD, MessagesByTopic, Payloads, stream
from spirob.logs.trace import Trace, moving_average
from spirob.robot import MOTORS

MAGIC = b"\x89MCAP0\r\n"
FILE_LIMIT = 256 * 2**20  # about 24 minutes of both motors at 1 kHz
_OWN = threading.local()  # each thread's decompressor: one shared by two spoils the data of both
BROKEN = (
    McapError,
    struct.error,
    ValueError,
    OverflowError,
    zstandard.ZstdError,
    RuntimeError,  # of lz4
)


@dataclass
class Content:
    """What a log file holds.

    metadata, attachments  by name
    messages  topic -> payloads in the order written: (n, size) uint8 where all have one size
    torn      the file breaks off; what stands here is complete up to there
    """

    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    messages: dict[str, Payloads] = field(default_factory=dict)
    torn: bool = False


def read_content(
    path: Path | str, torn: bool = False, topics: Collection[str] | None = None
) -> Content:
    """Read a whole MCAP file; with `torn`, accept one that breaks off.

    topics  those whose messages are wanted; None means all
    Raises MissingLog, and DataError where the file is torn, corrupt or no MCAP.
    """
    raw = read_bytes(path)
    content, messages = Content(), MessagesByTopic(len(raw), topics)
    try:
        try:
            for opcode, start, stop in _walk(raw):
                _take(raw, opcode, start, stop, content, messages)
        except EOFError:
            content.torn = True
        messages.settle()
    except BROKEN as error:
        raise DataError(f"{path}: the log is corrupt: {error or type(error).__name__}") from error
    if content.torn and not torn:
        raise DataError(f"{path}: the log is torn, it ends without a footer")
    content.messages = messages.by_topic()
    return content


def read_bytes(path: Path | str) -> bytes:
    """A whole MCAP file; raises MissingLog, and DataError where it is none or far too large."""
    try:
        with open(path, "rb") as file:
            size = os.fstat(file.fileno()).st_size
            raw = file.read(min(size, FILE_LIMIT))
    except FileNotFoundError:
        raise MissingLog(f"{path}: there is no such log") from None
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from error
    if not raw.startswith(MAGIC):
        raise DataError(f"{path}: this is not an MCAP file")
    if size > FILE_LIMIT:
        raise DataError(f"{path}: more than {FILE_LIMIT >> 20} MiB; record shorter trials")
    return raw


def _walk(raw: bytes) -> Iterator[tuple[int, int, int]]:
    """Opcode, start and stop of each record; EOFError where the file breaks off."""
    at, end = len(MAGIC), len(raw)
    while at + RECORD.size <= end:
        opcode, length = RECORD.unpack_from(raw, at)
        start, at = at + RECORD.size, at + RECORD.size + length
        if at > end:
            raise EOFError
        yield opcode, start, at
        if opcode == Opcode.FOOTER:
            if raw[at:] != MAGIC:
                raise EOFError
            return
    raise EOFError


def _take(
    raw: bytes, opcode: int, start: int, stop: int, content: Content, messages: MessagesByTopic
) -> None:
    record = raw[start:stop]
    if opcode == Opcode.CHUNK:
        messages.chunk(unpack_chunk(Chunk.read(stream(record))))
    elif opcode == Opcode.MESSAGE_INDEX:
        messages.index(record)
    elif opcode == Opcode.CHANNEL:
        messages.register(record)
    elif opcode == Opcode.METADATA:
        metadata = Metadata.read(stream(record))
        content.metadata[metadata.name] = metadata.metadata
    elif opcode == Opcode.ATTACHMENT:
        attachment = Attachment.read(stream(record))
        if zlib.crc32(record[:-4]) != int.from_bytes(record[-4:], "little"):
            raise ValueError(f"attachment '{attachment.name}' fails its checksum")
        content.attachments[attachment.name] = attachment.data
    elif opcode == Opcode.DATA_END:
        expected = DataEnd.read(stream(record)).data_section_crc
        if expected and zlib.crc32(memoryview(raw)[: start - RECORD.size]) != expected:
            raise ValueError("the data section fails its checksum")


def unpack_chunk(chunk: Chunk) -> bytes:
    """What a chunk holds; ValueError where its size, compression or checksum is wrong."""
    size, data = chunk.uncompressed_size, chunk.data
    if chunk.compression not in ("", "zstd", "lz4"):
        raise ValueError(f"compression '{chunk.compression}' is not supported, only zstd and lz4")
    if chunk.compression == "lz4":
        if size > CHUNK_LIMIT:
            raise ValueError(f"a chunk claims {size} bytes, more than {CHUNK_LIMIT}")
        data = LZ4FrameDecompressor().decompress(data, max_length=size + 1)
    elif chunk.compression:
        claimed = zstandard.frame_content_size(data)
        if max(size, claimed) > CHUNK_LIMIT:
            raise ValueError(f"a chunk claims {max(size, claimed)} bytes, more than {CHUNK_LIMIT}")
        data = _decompressor().decompress(data, max_output_size=size)
    if len(data) != size or (chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc):
        raise ValueError("a chunk fails its checksum")
    return data


def _decompressor() -> zstandard.ZstdDecompressor:
    """The thread's own; making one takes longer than a chunk does."""
    if not hasattr(_OWN, "made"):
        _OWN.made = zstandard.ZstdDecompressor()
    made: zstandard.ZstdDecompressor = _OWN.made
    return made


FILTER_WINDOW = 100  # samples of the current filter in the paper's set-up
SAFE_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # plain data only, both of them
DOCUMENT_LIMIT = 2**20  # bytes of trial.yaml
REFERENCE_UNITS = {CURRENT: "A", VELOCITY: "m/s", DISPLACEMENT: "m", FORCE: "N"}
CHANNELS = {
    "current": "A",
    "current_filtered": "A",
    "displacement": "m",
    "velocity": "m/s",
    "temperature": "degC",
    "command": "A",
    "reference": "by mode",
    "reference_rate": "m/s",
    "mode": "1",
}
VOLTAGE = {"voltage": "V"}  # a channel more of motors in voltage mode


def read_log(path: Path | str, torn: bool = False) -> Trace:
    """Decode one trial's log; with `torn`, take what a log that breaks off still holds.

    Raises MissingLog, MissingChannel, TooShort (shorter than the current filter) and DataError
    (torn, corrupt, not a log of a trial), each naming the file.
    """
    content = read_content(path, torn, (RAW_TOPIC, COMMAND_TOPIC))
    try:
        return _trace(str(path), content)
    except (MissingChannel, TooShort):
        raise
    except (DataError, ConfigError, ValueError, TypeError) as error:
        said = str(error)
        raise DataError(said if said.startswith(str(path)) else f"{path}: {said}") from error


def _trace(where: str, content: Content) -> Trace:
    for topic in (RAW_TOPIC, COMMAND_TOPIC):
        if not len(content.messages.get(topic, [])):
            raise MissingChannel(where, topic, list(content.messages))
    document = _document(content)
    transmission = Transmission.from_mapping(document["transmission"])
    assert isinstance(transmission, Transmission)
    raw, dropped = unpack_frames(content.messages[RAW_TOPIC])
    drive = _drive(content) if "drive" in document else None
    if drive:
        raw = translated(drive, raw)
    asked = unpack_commands(content.messages[COMMAND_TOPIC])
    volts = drive is not None and drive.by_voltage
    channels = CHANNELS | (VOLTAGE if volts else {})
    cycles = Cycles(where, raw, asked, volts)
    if cycles.count < FILTER_WINDOW:
        raise TooShort(where, cycles.count, FILTER_WINDOW, f"the {FILTER_WINDOW}-sample filter")
    signals: dict[str, np.ndarray] = {}
    units: dict[str, str] = {}
    for m, motor in enumerate(MOTORS):
        columns = cycles.feedback(m, transmission) | cycles.asked_of(m)
        columns["current_filtered"] = moving_average(columns["current"], FILTER_WINDOW, where)
        signals |= {f"{motor}.{name}": np.ascontiguousarray(columns[name]) for name in channels}
        units |= {f"{motor}.{name}": unit for name, unit in channels.items()}
        units[f"{motor}.reference"] = REFERENCE_UNITS.get(int(columns["mode"][0]), "")
    trial = document["trial"]
    meta = {
        "role": trial["role"],
        "rig": document["rig"],
        "scene": trial.get("scene") or {},
        "trial": trial,
        "transmission": document["transmission"],
        "about": content.metadata.get(ABOUT, {}),
        "frames": {"malformed": dropped, **cycles.counts},
        "torn": content.torn,
        "first_angle": cycles.first_angle,
    }
    if LOOP in content.metadata:
        meta[LOOP] = dict(content.metadata[LOOP])
    if STOPPED in content.metadata:
        meta[STOPPED] = content.metadata[STOPPED].get("reason", "")
    return Trace(str(trial["name"]), cycles.time_ns, signals, units, meta)


def _drive(content: Content) -> Drive:
    texts = [content.attachments.get(name) for name in (DRIVE_FILE, DBC_FILE)]
    if any(text is None or len(text) > DOCUMENT_LIMIT for text in texts):
        raise DataError(f"it needs attachments '{DRIVE_FILE}' and '{DBC_FILE}' of at most 1 MiB")
    text, dbc = (text.decode("utf-8", errors="replace") for text in texts if text is not None)
    return Drive.from_texts(text, dbc, DRIVE_FILE)


def _document(content: Content) -> dict[str, Any]:
    text = content.attachments.get(TRIAL_FILE)
    if text is None:
        raise DataError(f"it has no attachment '{TRIAL_FILE}', so it is no log of a trial")
    if len(text) > DOCUMENT_LIMIT:
        raise DataError(f"'{TRIAL_FILE}' has {len(text)} bytes, more than {DOCUMENT_LIMIT}")
    try:
        document = yaml.load(text, Loader=SAFE_LOADER)
        trial = document["trial"]
        complete = isinstance(trial, dict) and {"name", "role"} <= set(trial)
        complete = complete and isinstance(document["rig"], str)
        complete = complete and isinstance(document["transmission"], dict)
    except (yaml.YAMLError, UnicodeError, KeyError, TypeError, ValueError, RecursionError):
        complete = False
    if not complete:
        raise DataError(f"'{TRIAL_FILE}' needs trial (name, role), rig and transmission")
    return document
