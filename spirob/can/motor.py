"""What one drive last said, in SI at the tendon, and whether its current reading flickers.

A current reading that flickers at rest is the sign of life that a stuck sensor lacks.  Under a
constant command a motor that stands may rightly say the same for ever, if its readings carry no
noise; so constancy alone accuses nobody.  But a drive that has shown noise of several counts,
standing, under an unchanged command, does not fall silent in it: with a deviation of 1.3 counts two
readings are equal in less than a quarter of the cases, and twenty in a row never.
"""

from spirob.can_protocol import AMPERE_PER_COUNT, COUNTS_PER_TURN, decode_feedback

HALF_TURN = COUNTS_PER_TURN // 2
RPM_TO_COUNTS = COUNTS_PER_TURN / 60e9  # counts a nanosecond
MEMORY = 0.01  # of the disagreement between angle and speed that a frame forgets


class MotorState:
    """The latest feedback of one motor.

    displacement, velocity, current, temperature   [m], [m/s], [A], [°C]
    heard_ns   stamp of the latest frame;  changed_ns  of the latest that said anything new
    astray     counts by which the angle has of late moved otherwise than the speed says
    """

    __slots__ = (
        "angle",
        "answered",
        "astray",
        "changed_ns",
        "current",
        "data",
        "displacement",
        "heard_ns",
        "speed",
        "temperature",
        "turned",
        "velocity",
    )

    def __init__(self) -> None:
        self.answered = False
        self.angle = self.speed = self.turned = self.heard_ns = self.changed_ns = 0
        self.displacement = self.velocity = self.current = self.temperature = self.astray = 0.0
        self.data = b""

    def update(
        self, data: bytes, stamp_ns: int, metre_per_count: float, speed_per_rpm: float
    ) -> None:
        """Take in one feedback payload."""
        said = decode_feedback(data)
        if self.answered:
            step = (said.angle - self.angle + HALF_TURN) % COUNTS_PER_TURN - HALF_TURN
            self.turned += step
            # Of two speeds the smaller, so that one bad frame does not count as motion.
            speed = min(self.speed, said.speed, key=abs)
            expected = speed * RPM_TO_COUNTS * (stamp_ns - self.heard_ns)
            self.astray += step - expected - MEMORY * self.astray
        if data != self.data:
            self.data, self.changed_ns = data, stamp_ns
        self.answered = True
        self.angle, self.speed = said.angle, said.speed
        self.heard_ns = stamp_ns
        self.displacement = self.turned * metre_per_count
        self.velocity = said.speed * speed_per_rpm
        self.current = said.current * AMPERE_PER_COUNT
        self.temperature = float(said.temperature)

    def start_here(self) -> None:
        """Count length from where the motor is."""
        self.turned, self.displacement = 0, 0.0


CARRYING = 0.05  # A: below, a bridge may be off and its reading a true zero
SETTLED = 20  # frames since the command changed, for the current to follow
CHANGES = 30  # of the reading, seen at rest, before anything is concluded
NOISE = 2.0  # counts RMS of those changes: a deviation of 1.3, whatever the rounding
TIMES = 20  # as long as the longest pause seen at rest
WEAKER = 0.5  # of the largest current at which noise was seen: down to there it is expected


class Flicker:
    """The noise of one motor's current reading, learnt while it stands under one command.

    longest_ns   longest time for which the reading stayed the same meanwhile
    """

    __slots__ = (
        "_angle",
        "_changes",
        "_command",
        "_reading",
        "_same",
        "_since_ns",
        "_squares",
        "_strongest",
        "longest_ns",
    )

    def __init__(self) -> None:
        self._command = self._reading = self._squares = self._strongest = 0.0
        self._angle = self._changes = self._same = self._since_ns = self.longest_ns = 0

    def heard(self, command: float, angle: int, current: float, stamp_ns: int) -> None:
        """One feedback frame: command and current [A], angle [counts]."""
        resting = command == self._command and angle == self._angle
        self._same = self._same + 1 if resting else 0
        if current != self._reading or not resting:
            if self._same > SETTLED and abs(command) >= CARRYING:
                self._changes += 1
                self._squares += ((current - self._reading) / AMPERE_PER_COUNT) ** 2
                self._strongest = max(self._strongest, abs(command))
                self.longest_ns = max(self.longest_ns, stamp_ns - self._since_ns)
            self._since_ns = stamp_ns
        self._command, self._angle, self._reading = command, angle, current

    def expected(self, command: float) -> bool:
        """Whether the reading must flicker under this command [A], by what was seen."""
        return (
            self._changes >= CHANGES
            and self._squares >= NOISE**2 * self._changes
            and abs(command) >= max(CARRYING, WEAKER * self._strongest)
        )
