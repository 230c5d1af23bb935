"""A command brought within the limits on its size and slew, in the drive's own counts."""

from spirob.can_protocol import AMPERE_PER_COUNT, command_counts, command_payload
from spirob.drives.volts import VOLT_PER_COUNT
from spirob.robot import CYCLE_NS, MOTORS
from spirob.safety.limits import Limits

FRAME_PLACES = 4  # a command frame has room for four drives


class CommandLimiter:
    """Keeps what was sent last; a command within the limits passes unchanged, to the bit.

    most, slew  [A], [A/s] of currents, or [V], [V/s] of voltages;  per_count  their unit in a count
    Drives that do not belong to the robot get zero.  Going to zero as a stop is not limited: that
    does not pass through here.
    """

    def __init__(self, most: float, slew: float, per_count: float) -> None:
        self._high = int(most / per_count + 1e-9)
        self._step = max(1, int(slew * CYCLE_NS * 1e-9 / per_count + 1e-9))
        self._per_count = per_count
        self.sent = (0,) * FRAME_PLACES

    def __call__(self, command: bytes) -> bytes:
        """The payload to send; raises DataError where the command is none."""
        asked = command_counts(command)
        high, step = self._high, self._step
        allowed = tuple(
            max(-high, before - step, min(high, before + step, count)) if m < len(MOTORS) else 0
            for m, (count, before) in enumerate(zip(asked, self.sent, strict=True))
        )
        self.sent = allowed
        return command if allowed == asked else command_payload(allowed)

    def value(self, motor: int) -> float:
        """What was last sent to a motor [A], or [V] of voltages."""
        return self.sent[motor] * self._per_count

    def stop(self) -> None:
        """Zero was sent."""
        self.sent = (0,) * FRAME_PLACES


def of_currents(limits: Limits) -> CommandLimiter:
    """The limits of commanded currents."""
    return CommandLimiter(limits.current, limits.slew, AMPERE_PER_COUNT)


def of_voltages(limits: Limits) -> CommandLimiter:
    """The limits of commanded voltages."""
    return CommandLimiter(limits.voltage, limits.voltage_slew, VOLT_PER_COUNT)
