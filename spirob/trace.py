"""Named signals with units on one time base.

Every measurement and every simulation is a `Trace`: int64 nanoseconds, and one float array for
each channel, named `motor.signal` (`left.current`), SI units.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from spirob.errors import DataError, MissingChannel, TooShort

NANOSECONDS = 1e9


@dataclass(frozen=True)
class Trace:
    """Signals of one trial.

    name     of the trial, used in every message about it
    time_ns  (T,) int64, strictly increasing
    signals  channel -> (T,) float64
    units    channel -> unit, e.g. "A", "m", "m/s"
    meta     what is known of the trial besides its signals (role, scene, rig)
    """

    name: str
    time_ns: np.ndarray
    signals: Mapping[str, np.ndarray]
    units: Mapping[str, str]
    meta: Mapping[str, object] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if len(self.time_ns) > 1 and not np.all(np.diff(self.time_ns) > 0):
            raise DataError(f"{self.name}: time does not increase strictly")
        for channel, values in self.signals.items():
            if len(values) != len(self.time_ns):
                raise DataError(
                    f"{self.name}: channel '{channel}' has {len(values)} samples, "
                    f"time has {len(self.time_ns)}"
                )

    def __getitem__(self, channel: str) -> np.ndarray:
        if channel not in self.signals:
            raise MissingChannel(self.name, channel, list(self.signals))
        return self.signals[channel]

    def __len__(self) -> int:
        return len(self.time_ns)

    @property
    def seconds(self) -> np.ndarray:
        """Time since the first sample [s]."""
        return (self.time_ns - self.time_ns[0]) / NANOSECONDS

    @property
    def period(self) -> float:
        """Median time between samples [s]."""
        self.require(2, "a sampling period")
        return float(np.median(np.diff(self.time_ns))) / NANOSECONDS

    def require(self, samples: int, reason: str) -> None:
        """Raise TooShort where the trace has fewer samples than `reason` needs."""
        if len(self) < samples:
            raise TooShort(self.name, len(self), samples, reason)

    def require_finite(self, channels: list[str]) -> None:
        """Raise DataError where a needed channel holds NaN or infinity."""
        for channel in channels:
            bad = int(np.count_nonzero(~np.isfinite(self[channel])))
            if bad:
                raise DataError(f"{self.name}: channel '{channel}' holds {bad} non-finite samples")


def moving_average(values: np.ndarray, window: int, name: str = "signal") -> np.ndarray:
    """Causal mean of the last `window` samples (fewer at the start), same length.

    y[k] = (1/min(k+1, w)) Σ x[k-j], j = 0..w-1.  Group delay (w-1)/2 samples and nulls at
    multiples of f_s/w: at 1 kHz and w = 100, 49.5 ms and 10 Hz.  The filter of the paper's set-up.
    Raises TooShort where the signal is shorter than the window.
    """
    if len(values) < window:
        raise TooShort(name, len(values), window, f"the {window}-sample moving average")
    total = np.cumsum(np.concatenate([[0.0], values]))
    end = np.arange(1, len(values) + 1)
    start = np.maximum(0, end - window)
    return (total[end] - total[start]) / (end - start)
