"""Voltages as a command payload: four of them in counts, as `spirob.can_protocol` has currents.

The layout is that of GM6020-style motors: two bytes each, big-endian, ±25000 counts = ±24 V.  Their
DBC file, `gm6020.dbc`, is the truth; a test proves both equal.
"""

from spirob.can_protocol import command_counts, command_payload

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
