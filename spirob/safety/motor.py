"""What one drive last said, in SI at the tendon, zero length at the start of the trial."""

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
