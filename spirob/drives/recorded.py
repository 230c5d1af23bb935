"""All frames of a log of some drive as C620-style ones: what the controller saw, in bulk."""

import numpy as np

from spirob.can_protocol import (
    AMPERE_PER_COUNT,
    COMMAND_ID,
    COUNTS_PER_TURN,
    FEEDBACK_ID,
    feedback_payloads,
)
from spirob.drives.description import Motor
from spirob.drives.drive import FULL, Drive, factor, sources


def translated(drive: Drive, raw: np.ndarray) -> np.ndarray:
    """Records like `raw` (stamp_ns, id, data) with our ids and payloads, in the order received.

    A command of ours stands where the left motor's was sent, a feedback frame where an angle came;
    of a drive in voltage mode it is in counts of voltage.
    """
    places, parts = [], []
    for at, records in (_commands(drive, raw), *(_feedback(drive, raw, m) for m in range(2))):
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


def _feedback(drive: Drive, raw: np.ndarray, m: int) -> tuple[np.ndarray, np.ndarray]:
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
