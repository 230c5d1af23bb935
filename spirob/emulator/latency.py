"""How long the bus takes with voltages from the host: a reading's way up and a command's way down.

What the host reads is from the end of a cycle; the voltage that follows from it acts about a cycle
later.  How much later differs from machine to machine, and a little from frame to frame.
"""

from collections.abc import Sequence

import numpy as np
from numpy.random import Generator

from spirob.robot import CYCLE_NS

CYCLE = CYCLE_NS * 1e-9
MEAN = (0.7e-3, 1.3e-3)  # s, drawn for a machine: adapters, and drives with clocks of their own
JITTER = 0.1e-3  # s, either way, for each frame; less than half a cycle, so that order is kept
BLOCK = 1000  # frames whose jitter is drawn at once


class BusLatency:
    """Voltages on their way to the drives.

    mean  latency of this machine [s]
    """

    def __init__(self, machine: Generator):
        self.mean = float(machine.uniform(*MEAN))
        self._waiting: list[tuple[float, tuple[float, ...]]] = []

    def begin(self, trial: Generator) -> None:
        """A new trial: nothing is on its way."""
        self._source = trial
        self._jitter: list[float] = []
        self._waiting = []

    def arrivals(self, volts: Sequence[float]) -> list[tuple[float, tuple[float, ...]]]:
        """Send voltages at the start of a cycle; what comes within it: when [s], and what [V]."""
        if not self._jitter:
            self._jitter = self._source.uniform(-JITTER, JITTER, BLOCK).tolist()
        self._waiting.append((self.mean + self._jitter.pop(), tuple(volts)))
        come = [(at, v) for at, v in self._waiting if at < CYCLE * (1 - 1e-9)]
        later = self._waiting[len(come) :]
        self._waiting = [(max(0.0, at - CYCLE), v) for at, v in later]
        return come


def written(scratch: np.ndarray, come: Sequence[tuple[float, tuple[float, ...]]]) -> None:
    """Write down for the compiled step what comes in the next cycle."""
    scratch["coming"][0] = len(come)
    for k, (at, volts) in enumerate(come):
        scratch["comes_at"][0, k] = at
        scratch["coming_volts"][0, k] = volts
