"""A wrap in its parts: where it runs freely, where its current rises, where it ends.

The paper's filter delays the current by 49.5 ms, in which the tendon moves 2 mm; the displacement
goes through the same filter here, so that both belong to the same instant.  Levels are shares of
the rise from the free current to the plateau: friction and efficiency, in which a model and its
robot differ, scale and shift the current but leave these shares where they are.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

WINDOW = 100  # samples, the paper's filter
FREE = (0.45, 0.75)  # of the end stroke: past the start-up, before the rise
PLATEAU = 0.1  # of the log, at its end


@dataclass(frozen=True)
class Wrap:
    """One wrap from the start of the motion on; arrays are (T,).

    name      of the trial
    period    between samples [s]
    current   as measured, positive winding in [A];  filtered  after the 100-sample mean [A]
    stroke    wound-in length since the start [m];  delayed  after the same mean as the current [m]
    velocity  [m/s]
    """

    name: str
    period: float
    current: np.ndarray
    filtered: np.ndarray
    stroke: np.ndarray
    delayed: np.ndarray
    velocity: np.ndarray

    @cached_property
    def plateau(self) -> float:
        """Current at which the wrap ends [A]."""
        return float(np.median(self.filtered[-self.tail :]))

    @cached_property
    def end_stroke(self) -> float:
        """Wound-in length at the end [m]."""
        return float(np.median(self.stroke[-self.tail :]))

    @property
    def tail(self) -> int:
        """How many samples at the end count as the plateau."""
        return max(WINDOW, int(PLATEAU * len(self.current)))

    @cached_property
    def free(self) -> slice:
        """Samples of free motion between start-up and rise."""
        first, last = (self._reaches(share * self.end_stroke) for share in FREE)
        return slice(first, max(last, first + 2))

    def _reaches(self, stroke: float) -> int:
        return int(np.argmax(self.delayed >= stroke))

    @cached_property
    def _free_line(self) -> np.ndarray:
        # A straight line, because friction along the tendon grows as the arm bends.
        return np.polyfit(self.delayed[self.free], self.filtered[self.free], 1)

    @cached_property
    def free_current(self) -> float:
        """Current that free motion would need at the end stroke [A]."""
        return float(np.polyval(self._free_line, self.end_stroke))

    @cached_property
    def free_speed(self) -> float:
        """Speed of the free motion [m/s]."""
        return float(np.median(self.velocity[self.free]))

    @property
    def rise(self) -> float:
        """From the free current to the plateau [A]."""
        return self.plateau - self.free_current

    @cached_property
    def share(self) -> np.ndarray:
        """Excess over the free current as a share of the rise: about 0 when free, 1 at the end."""
        return (self.filtered - np.polyval(self._free_line, self.delayed)) / self.rise

    def when(self, level: float) -> float:
        """Sample, with fraction, from which on the share stays above a level below 1."""
        settled = int(np.argmax(self.share >= 0.95)) if (self.share >= 0.95).any() else -1
        below = np.flatnonzero(self.share[self.free.start : settled] < level)
        if not len(below):
            return float(self.free.start)
        k = self.free.start + int(below[-1])
        step = self.share[k + 1] - self.share[k]
        return k + (float(np.clip((level - self.share[k]) / step, 0.0, 1.0)) if step > 0 else 0.0)

    def stroke_at(self, level: float) -> float:
        """Wound-in length where the share passes a level [m]."""
        return float(np.interp(self.when(level), np.arange(len(self.delayed)), self.delayed))
