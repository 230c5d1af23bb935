"""Whether a bus is fast enough: frames of a cycle against the time that it has.

A frame of n bytes with an 11-bit id takes at most 8n + 44 + ⌊(34 + 8n - 1)/4⌋ + 3 bits with
stuffing and the pause after it: 135 for eight bytes.
"""

from spirob.drives.drive import FRAME_BYTES, Drive, sources
from spirob.errors import ConfigError

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
