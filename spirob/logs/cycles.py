"""The frames of a log sorted into cycles, and turned into SI units, motor by motor."""

from math import pi

import numpy as np

from spirob.can_protocol import (
    AMPERE_PER_COUNT,
    COMMAND_ID,
    COUNTS_PER_TURN,
    FEEDBACK_ID,
    VOLT_PER_COUNT,
    decode_feedback_array,
)
from spirob.errors import DataError, MissingChannel
from spirob.parameter import Numbers, bounded
from spirob.robot import CYCLE_NS, MOTORS

HALF_TURN = COUNTS_PER_TURN // 2


class Transmission(Numbers):
    """Nominal gearbox and winch between a drive's rotor and its tendon.

    x = r·θ/G [m] wound in, positive with positive rotor angle;  v = r·ω/G [m/s].
    """

    owner = "transmission"

    gear_ratio: float = bounded(3591 / 187, 0.01, 1e3, "1", "G", "rotor turns a winch turn")
    winch_radius: float = bounded(0.020, 1e-4, 1.0, "m", "r", "radius of the bare winch")

    @property
    def metre_per_count(self) -> float:
        """Tendon length a count of rotor angle [m]."""
        return 2 * pi / COUNTS_PER_TURN * self.winch_radius / self.gear_ratio

    @property
    def metre_per_second_per_rpm(self) -> float:
        """Tendon speed a revolution per minute of the rotor [m/s]."""
        return 2 * pi / 60 * self.winch_radius / self.gear_ratio


LONGEST_TRIAL = 24 * 3600 * 1000  # cycles; more is a broken time stamp


def rows_of(stamps: np.ndarray) -> np.ndarray:
    """The cycle each stamp belongs to, counted from the first."""
    if not np.all(stamps[1:] > stamps[:-1]):
        raise DataError("the time stamps of the commands do not increase")
    if int(stamps[-1]) - int(stamps[0]) >= LONGEST_TRIAL * CYCLE_NS:
        raise DataError("the time stamps span more than a day")
    return np.rint((stamps - stamps[0]) / CYCLE_NS).astype(np.int64)


def hold(rows: np.ndarray, cycles: int) -> tuple[np.ndarray, int, int]:
    """For each cycle the index of its latest sample, holding over gaps; gaps and duplicates.

    The cycles before the first sample take the first.
    """
    latest = np.full(cycles, -1)
    np.maximum.at(latest, rows, np.arange(len(rows)))
    filled = int(np.count_nonzero(latest >= 0))
    held = np.maximum(np.maximum.accumulate(latest), 0)
    return held, cycles - filled, len(rows) - filled


def unwrap(angle: np.ndarray) -> np.ndarray:
    """Counts since the first sample; right as long as a sample turns less than half a turn."""
    counts = angle.astype(np.int64)
    step = np.zeros_like(counts)
    step[1:] = counts[1:] - counts[:-1]
    return np.cumsum(np.mod(step + HALF_TURN, COUNTS_PER_TURN) - HALF_TURN)


class Cycles:
    """One trial's frames on an even time base.

    where  the file, for messages
    raw    `messages.FRAME` records in the order received
    asked  `messages.COMMAND` records, one a cycle
    volts  whether command frames are voltages; the commanded current is then the one asked for
    Raises DataError where time runs backwards, MissingChannel where no command frame was sent.
    """

    def __init__(self, where: str, raw: np.ndarray, asked: np.ndarray, volts: bool = False):
        self._volts = volts
        self._where, self._raw, self._asked = where, raw, asked
        stamps = asked["stamp_ns"]
        self._rows = rows_of(stamps)
        self.count = int(self._rows[-1]) + 1
        self.time_ns = stamps[0] + np.arange(self.count, dtype=np.int64) * CYCLE_NS
        self._asked_held, empty, _ = hold(self._rows, self.count)
        self.counts: dict[str, int] = {"empty_cycles": empty}
        self.first_angle: dict[str, float] = {}  # of each rotor [rad], in [0, 2π)

        sent = raw["id"] == COMMAND_ID
        sent_at = raw["stamp_ns"][sent]
        match = np.minimum(np.searchsorted(stamps, sent_at), len(stamps) - 1)
        in_trial = stamps[match] == sent_at
        if not in_trial.any():
            raise MissingChannel(where, f"command frame {COMMAND_ID:#x}", self._present())
        rows = self._rows[match[in_trial]]
        self._sent_held, self.counts["command.missing"], _ = hold(rows, self.count)
        per_count = VOLT_PER_COUNT if volts else AMPERE_PER_COUNT
        self._sent = raw["data"][sent][in_trial].copy().view(">i2") * per_count

        # Feedback belongs to the first cycle that starts after the command it followed.
        before = np.cumsum(sent) - 1
        followed = np.where(before >= 0, sent_at[before], np.iinfo(np.int64).min)
        self._next_cycle = np.searchsorted(stamps, followed, side="right")

    def feedback(self, number: int, transmission: Transmission) -> dict[str, np.ndarray]:
        """What a motor measured, at the tendon; raises MissingChannel where it never answered."""
        motor, frame = MOTORS[number], FEEDBACK_ID + 1 + number
        mine = (self._raw["id"] == frame) & (self._next_cycle < len(self._asked))
        if not mine.any():
            raise MissingChannel(self._where, f"{motor} feedback frame {frame:#x}", self._present())
        held, missing, duplicate = hold(self._rows[self._next_cycle[mine]], self.count)
        self.counts |= {f"{motor}.missing": missing, f"{motor}.duplicate": duplicate}
        said = decode_feedback_array(self._raw["data"][mine])
        turned = unwrap(said["angle"])[held]
        first = int(said["angle"][held[0]]) % COUNTS_PER_TURN
        self.first_angle[motor] = first * (2 * np.pi / COUNTS_PER_TURN)
        return {
            "current": said["current"][held] * AMPERE_PER_COUNT,
            "displacement": (turned - turned[0]) * transmission.metre_per_count,
            "velocity": said["speed"][held] * transmission.metre_per_second_per_rpm,
            "temperature": said["temperature"][held].astype(float),
        }

    def asked_of(self, number: int) -> dict[str, np.ndarray]:
        """What was asked of a motor: the current as sent on the bus, reference, rate and mode.

        Of a motor in voltage mode the voltage is what was sent, and the current, in whole counts,
        what its loop on the host was asked for.
        """
        names = ("reference", "reference_rate", "mode")
        columns = {n: self._asked[f"{MOTORS[number]}.{n}"][self._asked_held] for n in names}
        found = {name: values.astype(float) for name, values in columns.items()}
        sent = self._sent[self._sent_held, number]
        if not self._volts:
            return found | {"command": sent}
        current = self._asked[f"{MOTORS[number]}.current"][self._asked_held].astype(float)
        counted = np.rint(current / AMPERE_PER_COUNT) * AMPERE_PER_COUNT
        return found | {"command": counted, "voltage": sent}

    def _present(self) -> list[str]:
        return [f"{number:#x}" for number in np.unique(self._raw["id"]).tolist()[:20]]
