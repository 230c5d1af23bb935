"""Whether a drive's current reading flickers at rest: the sign of life that a stuck sensor lacks.

Under a constant command a motor that stands may rightly say the same for ever, if its readings
carry no noise; so constancy alone accuses nobody.  But a drive that has shown noise of several
counts, standing, under an unchanged command, does not fall silent in it: with a deviation of 1.3
counts two readings are equal in less than a quarter of the cases, and twenty in a row never.
"""

from spirob.can_protocol import AMPERE_PER_COUNT

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
