"""The messages of a DBC file; cantools is the truth, numpy the quick way where it may be.

A message whose signals all begin and end on a byte is one numpy record: decoded a file at a time
or one by one.  Any other is decoded by cantools.  Tests prove both equal on random payloads.

Voltages as a command payload: four of them in counts, as `spirob.can_protocol` has currents.

The layout is that of GM6020-style motors: two bytes each, big-endian, ±25000 counts = ±24 V.  Their
DBC file, `gm6020.dbc`, is the truth; a test proves both equal.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from cantools.database import Database, Error, load_string
from cantools.database.can import Message, Signal

from spirob.can_protocol import command_counts, command_payload
from spirob.errors import ConfigError, DataError

_SIZES = {8, 16, 32, 64}


@dataclass(frozen=True)
class Scale:
    """value = factor · raw + offset, in the order in which cantools computes it."""

    factor: float
    offset: float

    def __call__(self, raw: np.ndarray) -> np.ndarray:
        with np.errstate(invalid="ignore"):  # any bytes may be a float, signalling ones too
            values = raw.astype(float)
        if self.factor == 1 and self.offset == 0:
            return values
        return values * self.factor + self.offset

    def single(self, raw: float) -> float:
        """The value of one number, with the same bits."""
        if self.factor == 1 and self.offset == 0:
            return float(raw)
        return float(raw) * self.factor + self.offset


class Codec:
    """All messages of a DBC file, by name.

    Raises ConfigError where the text is no DBC file.
    """

    def __init__(self, text: str, where: str):
        self._where = where
        try:
            loaded = load_string(text, database_format="dbc", strict=True)
        except (Error, ValueError, TypeError, KeyError, RecursionError) as error:
            said = " ".join(str(error).split())[:200]
            raise ConfigError(f"{where}: is no DBC file: {said}") from None
        assert isinstance(loaded, Database)
        self._database = loaded
        self._layouts = {m.name: _layout(m) for m in loaded.messages}

    def message(self, name: str) -> Message:
        """One message; raises ConfigError with the known ones."""
        try:
            return self._database.get_message_by_name(name)
        except KeyError:
            known = ", ".join(self._layouts)
            raise ConfigError(f"{self._where}: no message '{name}'; known: {known}") from None

    def messages(self) -> list[Message]:
        """All of them."""
        return list(self._database.messages)

    def unit(self, message: str, signal: str) -> str:
        """The unit of a signal; raises ConfigError where there is no such signal."""
        return self._signal(message, signal).unit or ""

    def compiled(self, message: str) -> bool:
        """Whether a message is decoded by numpy."""
        return self._layouts[message] is not None

    def encode(self, message: str, values: Mapping[str, float]) -> bytes:
        """A payload; signals that are not named are zero."""
        whole = {s.name: 0 for s in self.message(message).signals} | dict(values)
        return self.message(message).encode(whole, strict=False)

    def decode(self, message: str, payload: bytes) -> dict[str, float]:
        """One payload; raises DataError where it is too short."""
        found = self._layouts[message]
        if found is None or len(payload) < found[0].itemsize:
            many = self.decode_many(message, np.frombuffer(payload, np.uint8)[None, :])
            return {name: float(values[0]) for name, values in many.items()}
        layout, scales = found
        raw = np.frombuffer(payload, layout, 1)[0].item()
        return {name: one.single(r) for (name, one), r in zip(scales.items(), raw, strict=True)}

    def decode_many(self, message: str, payloads: np.ndarray) -> dict[str, np.ndarray]:
        """Signals of many payloads, (n, size) uint8, each (n,) float.

        Raises DataError where they are shorter than the message.
        """
        size = self.message(message).length
        if payloads.shape[1] < size:
            raise DataError(f"{message}: {payloads.shape[1]} bytes; the DBC file says {size}")
        found = self._layouts[message]
        if found is None:
            rows = [self._one(message, bytes(row[:size])) for row in payloads]
            names = [s.name for s in self.message(message).signals]
            return {name: np.array([row[name] for row in rows], float) for name in names}
        layout, scales = found
        records = np.ascontiguousarray(payloads[:, :size]).view(layout)[:, 0]
        return {name: scale(records[name]) for name, scale in scales.items()}

    def _one(self, message: str, payload: bytes) -> dict[str, Any]:
        decoded = self.message(message).decode(payload, decode_choices=False)
        assert isinstance(decoded, dict)
        return decoded

    def _signal(self, message: str, signal: str) -> Signal:
        for one in self.message(message).signals:
            if one.name == signal:
                return one
        known = ", ".join(s.name for s in self.message(message).signals)
        raise ConfigError(f"{self._where}: {message} has no signal '{signal}'; it has: {known}")


def _layout(message: Message) -> tuple[np.dtype, dict[str, Scale]] | None:
    if message.is_multiplexed() or message.length == 0 or not message.signals:
        return None
    names, formats, offsets, scales = [], [], [], {}
    for signal in message.signals:
        big = signal.byte_order == "big_endian"
        aligned = signal.start % 8 == (7 if big else 0) and signal.length in _SIZES
        if not aligned or (signal.is_float and signal.length == 8):
            return None
        kind = "f" if signal.is_float else "i" if signal.is_signed else "u"
        if kind != "f" and signal.length == 64:
            return None  # beyond what a float holds exactly
        names.append(signal.name)
        formats.append(f"{'>' if big else '<'}{kind}{signal.length // 8}")
        offsets.append(signal.start // 8)
        scales[signal.name] = Scale(float(signal.scale), float(signal.offset))
    layout = {"names": names, "formats": formats, "offsets": offsets, "itemsize": message.length}
    return np.dtype(layout), scales  # type: ignore[call-overload]


VOLTAGE_ID = 0x1FF
VOLTAGE_FEEDBACK_ID = 0x204  # plus the motor's number, from 1
FULL_SCALE = 25000  # counts
VOLT_PER_COUNT = 24.0 / FULL_SCALE
PLACES = 4  # motors in a frame


def encode_volts(volts: tuple[float, ...]) -> bytes:
    """The payload for up to four voltages [V], rounded to counts; what is no number is zero."""
    counts = [round(max(-24.0, min(24.0, u)) / VOLT_PER_COUNT) if u == u else 0 for u in volts]
    return command_payload((*counts, *([0] * (PLACES - len(counts)))))


def decode_volts(data: bytes, motors: int = 2) -> tuple[float, ...]:
    """The voltages [V] in a payload; raises DataError on another size."""
    return tuple(count * VOLT_PER_COUNT for count in command_counts(data)[:motors])
