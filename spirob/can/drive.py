"""A kind of drive: what goes out for a command, what its frames say, on a bus that is fast enough.

A bus is fast enough where the frames of a cycle fit into the time that it has.  A frame of n bytes
with an 11-bit id takes at most 8n + 44 + ⌊(34 + 8n - 1)/4⌋ + 3 bits with stuffing and the pause
after it: 135 for eight bytes.

`translated` takes all frames of a log at once to C620-style ones: what the controller saw.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np

from spirob import files, plain_yaml
from spirob.can.description import (
    UNITS,
    VOLTS,
    Codec,
    Description,
    Motor,
    Sent,
    Source,
    description_from,
)
from spirob.can_protocol import (
    AMPERE_PER_COUNT,
    COMMAND_ID,
    COUNTS_PER_TURN,
    FEEDBACK_ID,
    VOLT_PER_COUNT,
    CanFrame,
    Feedback,
    command_counts,
    encode_feedback,
    feedback_payloads,
)
from spirob.errors import ConfigError

MOTORS = ("left", "right")
LARGEST = 2**20  # bytes of a description or a DBC file
FULL = 32767
FRAME_BYTES = 8  # of the frames that logs decode


@dataclass(frozen=True)
class Drive:
    """A description with its DBC file; raises ConfigError where they do not fit.

    text, dbc_text  both files as they were, for the log
    """

    text: str
    dbc_text: str
    about: Description
    codec: Codec

    @classmethod
    def from_texts(cls, text: str, dbc_text: str, where: str) -> "Drive":
        """A drive from the content of both files."""
        about = description_from(plain_yaml.read(text, where), where)
        drive = cls(text, dbc_text, about, Codec(dbc_text, f"{where}: {about.dbc}"))
        drive._check(where)
        return drive

    def _check(self, where: str) -> None:
        for name, motor in zip(MOTORS, self.motors, strict=True):
            unit = self.codec.unit(motor.command.message, motor.command.signal)
            if self.by_voltage and unit not in VOLTS:
                raise ConfigError(
                    f"{where}: motors.{name}.command: the DBC file gives '{unit}' for "
                    f"{motor.command.signal}; a voltage is in {' or '.join(VOLTS)}"
                )
            for kind, source in sources(motor).items():
                unit = self.codec.unit(source.message, source.signal)
                if unit not in UNITS[kind]:
                    raise ConfigError(
                        f"{where}: motors.{name}.{kind}: the DBC file gives '{unit}' for "
                        f"{source.signal}; known: {', '.join(UNITS[kind])}"
                    )
        for motor in self.motors:
            names = [motor.command.message, *(s.message for s in sources(motor).values())]
            for message in map(self.codec.message, names):
                if message.length != FRAME_BYTES or message.is_extended_frame:
                    raise ConfigError(
                        f"{where}: {message.name} is not a frame of {FRAME_BYTES} bytes "
                        "with an 11-bit id"
                    )
        for one in (*self.about.arm, *self.about.disarm):
            for signal in one.values:
                self.codec.unit(one.message, signal)

    @property
    def motors(self) -> tuple[Motor, Motor]:
        """Both, in the order of MOTORS."""
        return self.about.motors.left, self.about.motors.right

    @property
    def by_voltage(self) -> bool:
        """Whether a command is a voltage, so that the host closes the current loop."""
        return self.motors[0].command.per_volt is not None

    def scale(self, motor: Motor) -> float:
        """What a command's signal is for one ampere, or for one volt of a drive that takes one."""
        asked = motor.command
        if asked.per_volt is None:
            return asked.per_ampere
        return asked.per_volt / VOLTS[self.codec.unit(asked.message, asked.signal)]

    @property
    def per_count(self) -> float:
        """Amperes, or volts, in a count of our command payload."""
        return VOLT_PER_COUNT if self.by_voltage else AMPERE_PER_COUNT

    def frame_id(self, message: str) -> int:
        """The arbitration id of a message."""
        return self.codec.message(message).frame_id

    def commands(self, payload: bytes) -> list[tuple[int, bytes]]:
        """What to send for a command payload of ours: id and data of each message.

        payload  in counts of current, or of voltage where the drive takes one
        """
        values: dict[str, dict[str, float]] = {}
        for motor, count in zip(self.motors, command_counts(payload), strict=False):
            asked = motor.command
            value = count * self.per_count * self.scale(motor)
            values.setdefault(asked.message, {})[asked.signal] = value
        return [(self.frame_id(m), self.codec.encode(m, signals)) for m, signals in values.items()]

    def sent(self, messages: Sequence[Sent]) -> list[tuple[int, bytes]]:
        """Messages of fixed values, such as those that arm: id and data."""
        return [
            (self.frame_id(m.message), self.codec.encode(m.message, m.values)) for m in messages
        ]


def sources(motor: Motor) -> dict[str, Source]:
    """The feedback signals of a motor by kind."""
    found = {"angle": motor.angle, "speed": motor.speed, "current": motor.current}
    return found | ({"temperature": motor.temperature} if motor.temperature else {})


def factor(drive: Drive, kind: str, source: Source) -> float:
    """From the DBC's unit to turns, rpm, A or °C, with the sign."""
    return source.sign * UNITS[kind][drive.codec.unit(source.message, source.signal)]


class Translator:
    """A drive's frames as C620-style ones, as they come; other frames say nothing.

    A feedback frame of ours comes with each angle, and holds the latest of the other signals.
    """

    def __init__(self, drive: Drive):
        self._drive = drive
        self._latest = [dict.fromkeys(UNITS, 0.0) for _ in MOTORS]
        self._by_id: dict[int, list[tuple[int, str, Source, float]]] = {}
        for m, motor in enumerate(drive.motors):
            for kind, source in sources(motor).items():
                row = (m, kind, source, factor(drive, kind, source))
                self._by_id.setdefault(drive.frame_id(source.message), []).append(row)

    def __call__(self, frames: Sequence[CanFrame]) -> list[CanFrame]:
        """The command (the first frame stands for it) and feedback frames of ours."""
        out = [CanFrame(frames[0].stamp_ns, COMMAND_ID, bytes(8))] if frames else []
        for frame in frames[1:]:
            rows = self._by_id.get(frame.arbitration_id, ())
            if not rows or len(frame.data) < self._drive.codec.message(rows[0][2].message).length:
                continue
            said = self._drive.codec.decode(rows[0][2].message, frame.data)
            for m, kind, source, to_ours in rows:
                self._latest[m][kind] = to_ours * said[source.signal]
            for m in {row[0] for row in rows if row[1] == "angle"}:
                data = encode_feedback(_feedback(self._latest[m]))
                out.append(CanFrame(frame.stamp_ns, FEEDBACK_ID + 1 + m, data))
        return out


def _feedback(latest: dict[str, float]) -> Feedback:
    return Feedback(
        angle=_round(latest["angle"] * COUNTS_PER_TURN, 2**53) % COUNTS_PER_TURN,
        speed=_round(latest["speed"], FULL),
        current=_round(latest["current"] / AMPERE_PER_COUNT, FULL),
        temperature=max(0, _round(latest["temperature"], 255)),
    )


def _round(value: float, most: int) -> int:
    """The nearest count within ± most; what is no number is the most, so that it stops a trial."""
    return round(max(-most, min(most, value))) if value == value else most


def find_drive(name: str) -> Drive:
    """A drive of the library by name, or the description in a file of your own.

    Raises ConfigError or DataError naming the file.
    """
    own = Path(name)
    if own.suffix in (".yaml", ".yml"):
        text = _read(own)
        about = description_from(plain_yaml.read(text, str(own)), str(own))
        return Drive.from_texts(text, _read(own.parent / about.dbc), str(own))
    folder = resources.files("spirob.can").joinpath("drives")
    known = sorted(f.name[:-5] for f in folder.iterdir() if f.name.endswith(".yaml"))
    if name not in known:
        raise ConfigError(f"no drive '{name}'; known: c620, {', '.join(known)}, or a .yaml file")
    text = folder.joinpath(f"{name}.yaml").read_text(encoding="utf-8")
    dbc = description_from(plain_yaml.read(text, name), name).dbc
    return Drive.from_texts(text, folder.joinpath(dbc).read_text(encoding="utf-8"), name)


def _read(path: Path) -> str:
    content = files.content(path, "description of a drive", LARGEST)
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")  # as older DBC editors write


LONGEST = 8 * FRAME_BYTES + 44 + (34 + 8 * FRAME_BYTES - 1) // 4 + 3  # bits
CYCLE = 1e-3  # s


def seconds_a_cycle(drive: Drive, bitrate: float) -> float:
    """How long the frames of one cycle of a drive take at most, at a bit rate [bit/s]."""
    names = {motor.command.message for motor in drive.motors}
    for motor in drive.motors:
        names |= {s.message for kind, s in sources(motor).items() if kind != "temperature"}
    return len(names) * LONGEST / bitrate


def require_fast_enough(drive: Drive, bitrate: float) -> None:
    """Raises ConfigError where the frames of a cycle do not fit into its millisecond."""
    needed = seconds_a_cycle(drive, bitrate)
    if needed > CYCLE:
        raise ConfigError(
            f"a bus of {bitrate / 1e3:g} kbit/s is slower than the loop on the host: the frames "
            f"of a cycle of {drive.about.name} take up to {1e3 * needed:.2f} ms, and it has 1 ms"
        )


def translated(drive: Drive, raw: np.ndarray) -> np.ndarray:
    """Records like `raw` (stamp_ns, id, data) with our ids and payloads, in the order received.

    A command of ours stands where the left motor's was sent, a feedback frame where an angle came;
    of a drive in voltage mode it is in counts of voltage.
    """
    places, parts = [], []
    for at, records in (_commands(drive, raw), *(_received(drive, raw, m) for m in range(2))):
        places.append(at)
        parts.append(records)
    order = np.argsort(np.concatenate(places), kind="stable")
    return np.concatenate(parts)[order]


def _commands(drive: Drive, raw: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    (at, counts), *others = [_sent(drive, raw, motor) for motor in drive.motors]
    payloads = np.zeros((len(at), 4), ">i2")
    payloads[:, 0] = counts
    for m, (places, values) in enumerate(others, 1):
        # the command of the same cycle follows the left motor's, and comes before its next
        mine = np.searchsorted(places, at)
        there = mine < len(places)
        payloads[there, m] = values[mine[there]]
    records = raw[at].copy()
    records["id"] = COMMAND_ID
    records["data"] = payloads.view(np.uint8).reshape(-1, 8)
    return at, records


def _sent(drive: Drive, raw: np.ndarray, motor: Motor) -> tuple[np.ndarray, np.ndarray]:
    asked = motor.command
    at = np.flatnonzero(raw["id"] == drive.frame_id(asked.message))
    values = drive.codec.decode_many(asked.message, raw["data"][at])[asked.signal]
    return at, _counts(values / drive.scale(motor) / drive.per_count, FULL)


def _received(drive: Drive, raw: np.ndarray, m: int) -> tuple[np.ndarray, np.ndarray]:
    motor = drive.motors[m]
    at = np.flatnonzero(raw["id"] == drive.frame_id(motor.angle.message))
    latest = {}
    for kind, source in sources(motor).items():
        mine = np.flatnonzero(raw["id"] == drive.frame_id(source.message))
        values = drive.codec.decode_many(source.message, raw["data"][mine])[source.signal]
        before = np.searchsorted(mine, at, side="right") - 1
        found = np.append(factor(drive, kind, source) * values, 0.0)  # 0 before the first
        latest[kind] = found[np.where(before >= 0, before, len(values))]
    angle = _counts(latest["angle"] * COUNTS_PER_TURN, 2**53) % COUNTS_PER_TURN
    records = raw[at].copy()
    records["id"] = FEEDBACK_ID + 1 + m
    records["data"] = feedback_payloads(
        angle,
        _counts(latest["speed"], FULL),
        _counts(latest["current"] / AMPERE_PER_COUNT, FULL),
        np.maximum(0, _counts(latest.get("temperature", np.zeros(len(at))), 255)),
    )
    return at, records


def _counts(values: np.ndarray, most: int) -> np.ndarray:
    """As `Translator` rounds: nearest, half to even, within ± most; no number is the most."""
    finite = np.where(np.isnan(values), float(most), values)
    return np.rint(np.clip(finite, -float(most), float(most))).astype(np.int64)
