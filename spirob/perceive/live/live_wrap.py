"""A wrap as it grows: from the start of winding in until it has tightened.

The tendon stands soon; the current goes on rising to the limit of its command, and sizes are read
at shares of that rise.  So the wrap is over when the tendon stands and the current is steady.  What
was taken in is then read as a log would be (`perceive.wrap`), so the same sentences tell why a
motion was no wrap.
"""

from collections import deque

import numpy as np

from spirob.perceive.live.grid import Sample
from spirob.perceive.spectral import SECONDS
from spirob.perceive.wrap import LEAST_STROKE, STILL_MOVING
from spirob.robot import CYCLE_NS
from spirob.trace import Trace

BEFORE = 300  # samples kept from before the motion
STANDS = 500  # samples
STEADY = 300  # samples, whose mean current is compared with that of as many before
SAME = 0.01  # of the current
LEAST = BEFORE + round(SECONDS * 1e9 / CYCLE_NS)  # samples: spectra have a window of their own
LONGEST_WRAP = 60_000  # samples
SIGNALS = {"displacement": "m", "velocity": "m/s", "current": "A"}


class LiveWrap:
    """Collects one motor's samples; `take` gives a trace where a wrap, or what may be one, ends."""

    def __init__(self, motor: str):
        self._motor = motor
        self._before: deque[Sample] = deque(maxlen=BEFORE)
        self.forget()

    def forget(self) -> None:
        """Nothing is being wrapped."""
        self._samples: list[Sample] = []
        self._fastest = 0.0
        self._standing = 0
        self._before.clear()

    def begin(self) -> None:
        """The motor has begun to wind in."""
        if not self._samples:
            self._samples = list(self._before)

    def take(self, sample: Sample) -> Trace | None:
        """Take in a sample; the trace of the motion if it has just ended."""
        if not self._samples:
            self._before.append(sample)
            return None
        self._samples.append(sample)
        self._fastest = max(self._fastest, sample.velocity)
        still = abs(sample.velocity) <= STILL_MOVING * self._fastest
        self._standing = self._standing + 1 if still else 0
        if not self._over():
            return None
        motion = np.array(self._samples)
        self.forget()
        if np.ptp(motion[:, 0]) < LEAST_STROKE:  # a twitch
            return None
        channels = dict(zip(SIGNALS, motion.T, strict=True))
        return Trace(
            "what was wound in",
            np.arange(len(motion), dtype=np.int64) * CYCLE_NS,
            {f"{self._motor}.{name}": values for name, values in channels.items()},
            {f"{self._motor}.{name}": unit for name, unit in SIGNALS.items()},
        )

    def _over(self) -> bool:
        count = len(self._samples)
        if count >= LONGEST_WRAP:
            return True
        # steadiness is looked at now and then only, for it costs more than the rest
        if self._standing < STANDS or count < LEAST or count % 20:
            return False
        current = np.array([s.current for s in self._samples[-2 * STEADY :]])
        before, now = float(current[:STEADY].mean()), float(current[STEADY:].mean())
        return abs(now - before) <= SAME * abs(now)
