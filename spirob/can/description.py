"""What is known of a drive: its description, and the DBC file beside it, units included.

    name: odrive
    dbc: odrive.dbc
    motors:
      left:
        command: {message: Axis0_Set_Input_Torque, signal: Input_Torque, per_ampere: 0.0203}
        angle: {message: Axis0_Get_Encoder_Estimates, signal: Pos_Estimate}
        speed: {message: Axis0_Get_Encoder_Estimates, signal: Vel_Estimate}
        current: {message: Axis0_Get_Iq, signal: Iq_Measured}
        temperature: {message: Axis0_Get_Temperature, signal: Motor_Temperature}
      right: ...
    arm: [{message: Axis0_Set_Axis_State, values: {Axis_Requested_State: 8}}]
    disarm: ...

`per_ampere`: what the signal is for one ampere of the motor's current; negative where the drive
counts the other way round, as `sign: -1` is for feedback.  `per_volt` stands instead where the
drive takes a voltage: 1, or -1 where a positive one pays out; the unit, V or mV, is the DBC's.

Of the messages of a DBC file cantools is the truth, numpy the quick way where it may be.  A message
whose signals all begin and end on a byte is one numpy record: decoded a file at a time or one by
one.  Any other is decoded by cantools.  Tests prove both equal on random payloads.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from typing import Annotated, Any, Literal, Self

import numpy as np
from cantools.database import Database, Error, load_string
from cantools.database.can import Message, Signal
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    StringConstraints,
    ValidationError,
    model_validator,
)

from spirob.errors import ConfigError, DataError
from spirob.units import Size, SizeNotZero, number

Text = Annotated[str, StringConstraints(min_length=1, max_length=200)]
TURNS = {"turn": 1.0, "rev": 1.0, "rad": 1 / (2 * pi), "deg": 1 / 360, "count": 1 / 8192}
RPM = {"rpm": 1.0, "rev/s": 60.0, "turn/s": 60.0, "rad/s": 60 / (2 * pi), "deg/s": 1 / 6}
AMPERES = {"A": 1.0, "mA": 1e-3}
VOLTS = {"V": 1.0, "mV": 1e-3}
CELSIUS = {"degC": 1.0, "°C": 1.0, "C": 1.0}
UNITS = {"angle": TURNS, "speed": RPM, "current": AMPERES, "temperature": CELSIUS}
_SIZES = {8, 16, 32, 64}


class Strict(BaseModel):
    """No key that is not declared."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Source(Strict):
    """One signal of one message."""

    message: Text
    signal: Text
    sign: Annotated[Literal[1, -1], BeforeValidator(number)] = 1


class Command(Strict):
    """The signal that commands a motor's current, or its voltage where `per_volt` is given."""

    message: Text
    signal: Text
    per_ampere: SizeNotZero = 1.0
    per_volt: SizeNotZero | None = None

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if self.per_volt is not None and "per_ampere" in self.model_fields_set:
            raise ValueError("per_ampere or per_volt, not both: it is a current or a voltage")
        return self


class Motor(Strict):
    """One motor: how it is commanded, and what it says; `angle` comes last in a cycle."""

    command: Command
    angle: Source
    speed: Source
    current: Source
    temperature: Source | None = None


class Sent(Strict):
    """A message with fixed values."""

    message: Text
    values: dict[Text, Size] = {}


class Motors(Strict):
    """Both motors of the arm."""

    left: Motor
    right: Motor

    @model_validator(mode="after")
    def _alike(self) -> Self:
        if (self.left.command.per_volt is None) != (self.right.command.per_volt is None):
            raise ValueError("both motors take a current, or both a voltage")
        return self


class Description(Strict):
    """A whole description."""

    name: Text
    dbc: Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.\-]{0,99}$")]
    motors: Motors
    arm: list[Sent] = Field([], max_length=50)
    disarm: list[Sent] = Field([], max_length=50)


def description_from(plain: object, where: str) -> Description:
    """A description from plain data; raises ConfigError naming `where` and the key."""
    try:
        return Description.model_validate(plain)
    except (ValidationError, RecursionError) as error:
        if isinstance(error, RecursionError):
            raise ConfigError(f"{where}: is nested too deeply") from None
        first = error.errors(include_input=False, include_url=False)[0]
        key = ".".join(str(part) for part in first["loc"]) or "the file"
        said = first["msg"].removeprefix("Value error, ")
        raise ConfigError(f"{where}: key '{key[:200]}': {said}") from None


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
