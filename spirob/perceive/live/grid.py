"""Feedback as it arrives, early, late or not at all, onto samples at equal distances in time.

Every rule and every feature counts samples.  The grid is anchored where the first frame came, so
that lateness does not add up: of two frames in one period the later one is passed over, and up to
`LONGEST` lost ones are filled by a straight line.  A longer silence begins a new grid.
"""

from typing import NamedTuple

from spirob.robot import CYCLE_NS

LONGEST = 50  # periods


class Sample(NamedTuple):
    """One motor at one instant: displacement [m], velocity [m/s], current [A]."""

    displacement: float
    velocity: float
    current: float


class Grid:
    """Regular samples of one motor, every `CYCLE_NS`."""

    def __init__(self) -> None:
        self.broken = False  # whether the last `take` had to begin anew
        self._zero_ns = self._number = 0
        self._last: Sample | None = None

    def take(self, stamp_ns: int, sample: Sample) -> list[Sample]:
        """The samples that are known with this one, in order; often one, sometimes none."""
        number = round((stamp_ns - self._zero_ns) / CYCLE_NS)
        before, self.broken = self._last, False
        if before is None or not -LONGEST <= number - self._number <= LONGEST:
            self.broken = before is not None
            self._zero_ns, self._number, self._last = stamp_ns, 0, sample
            return [sample]
        steps = number - self._number
        if steps <= 0:
            return []
        self._number, self._last = number, sample
        return [_between(before, sample, k / steps) for k in range(1, steps)] + [sample]


def _between(one: Sample, other: Sample, share: float) -> Sample:
    return Sample(*(a + share * (b - a) for a, b in zip(one, other, strict=True)))
