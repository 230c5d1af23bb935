"""A command brought within the limits on current and slew, in the drive's own counts."""

from spirob.can_protocol import AMPERE_PER_COUNT, command_counts, command_payload
from spirob.robot import CYCLE_NS, MOTORS
from spirob.safety.limits import Limits

FRAME_CURRENTS = 4  # a command frame has room for four drives


class CommandLimiter:
    """Keeps what was sent last; a command within the limits passes unchanged, to the bit.

    Drives that do not belong to the robot get zero.  Going to zero as a stop is not limited: that
    does not pass through here.
    """

    def __init__(self, limits: Limits) -> None:
        self._high = int(limits.current / AMPERE_PER_COUNT + 1e-9)
        self._step = max(1, int(limits.slew * CYCLE_NS * 1e-9 / AMPERE_PER_COUNT + 1e-9))
        self.sent = (0,) * FRAME_CURRENTS

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

    def amperes(self, motor: int) -> float:
        """What was last sent to a motor [A]."""
        return self.sent[motor] * AMPERE_PER_COUNT

    def stop(self) -> None:
        """Zero was sent."""
        self.sent = (0,) * FRAME_CURRENTS
