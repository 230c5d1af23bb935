"""Limits that no command may leave, and a command brought within them, in the drive's counts."""

from spirob.can_protocol import AMPERE_PER_COUNT, command_counts, command_payload
from spirob.drives.codec import VOLT_PER_COUNT
from spirob.parameter import Numbers, bounded
from spirob.robot import CYCLE_NS, MOTORS


class Limits(Numbers):
    """Wide defaults, which the drive itself nearly keeps; a real robot's configuration has its own.

    Commands beyond `current` and `slew`, and voltages beyond theirs, are brought back to them;
    anything else stops the trial.
    `speed` times `silence` should stay below half a rotor turn, so that lost frames cannot hide
    a whole one.
    """

    owner = "safety"

    current: float = bounded(20.0, 0.01, 20.0, "A", "i_max", "size of a commanded current")
    slew: float = bounded(4e4, 1.0, 1e6, "A/s", "s_max", "rate of a commanded current")
    voltage: float = bounded(24.0, 0.1, 24.0, "V", "u_max", "size of a commanded voltage")
    voltage_slew: float = bounded(4.8e4, 1.0, 1e6, "V/s", "u̇_max", "rate of a commanded voltage")
    travel: float = bounded(1.0, 0.001, 10.0, "m", "x_max", "wound-in length since the start")
    speed: float = bounded(5.0, 0.001, 100.0, "m/s", "v_max", "speed of a tendon")
    temperature: float = bounded(100.0, 30.0, 150.0, "degC", "T_max", "winding, as reported")
    silence: float = bounded(0.010, 0.002, 1.0, "s", "t_s", "without feedback of a motor")
    following: float = bounded(1.0, 0.01, 40.0, "A", "e_max", "command less reported current")
    following_time: float = bounded(0.25, 0.005, 10.0, "s", "t_e", "for how long, at a stretch")
    frozen: float = bounded(0.05, 0.005, 10.0, "s", "t_f", "with bit-identical feedback")


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
