"""Recoil from a contact: the trial goes on with its last part as soon as the detector speaks.

A model may also repeat the motion of another side, and recoil when that one did.
"""

from collections import deque
from collections.abc import Sequence

from spirob.experiments.response import PERIOD
from spirob.experiments.side import WINDOW
from spirob.perceive.contact import ContactDetector, ContactSettings


class Recoil:
    """The streaming contact detector on one motor, as a `spirob.bench.reaction.Reaction`.

    motor   whose current is heard;  filtered  through the paper's 100-sample mean
    begins  row from which on it listens;  ends  first row of the recoil, which comes at the latest
            when the schedule has come there by itself
    told    row at which a contact was declared, None where none was
    """

    def __init__(
        self, motor: int, filtered: bool, begins: int, ends: int, rules: ContactSettings
    ) -> None:
        # the mean is a trial's: it has heard what came before, in the log as on the robot
        self.begins = begins - WINDOW if filtered else begins
        self.ends = ends
        self.told: int | None = None
        self._motor, self._first = motor, begins
        self._detector = ContactDetector(rules, PERIOD)
        self._heard: deque[float] = deque(maxlen=WINDOW if filtered else 1)

    def __call__(self, row: int, currents: Sequence[float]) -> int:
        """Listen; the recoil's first row where a contact is declared."""
        self._heard.append(currents[self._motor])
        if row < self._first:
            return row
        level = sum(self._heard) / len(self._heard)
        if self._detector.update(level) is None:
            return row
        self.told = row
        return self.ends


class Repeat:
    """The recoil of another side, at the row at which that one's began; none where none did."""

    def __init__(self, told: int | None, begins: int, ends: int) -> None:
        self.begins, self.ends, self.told = begins, ends, told

    def __call__(self, row: int, currents: Sequence[float]) -> int:
        """The recoil's first row where the other recoiled."""
        return self.ends if row == self.told else row
