"""Contact told from one motor's current: sample by sample, or for a whole log at once.

Three rules, any of which declares a contact (paper, "Active Perception"), seen against a baseline
that rolls along, so that slow changes of load pass:

    absolute   s (i - i_0) > a                    a = 0.8 A
    relative   s (i - i_0) > r max(|i_0|, i_min)  r = 0.5
    slope      s di/dt > g                        g = 6 A/s

i is the mean of the last `smoothing` seconds, i_0 the mean of the `baseline` seconds that end one
`window` ago, s the sign of i_0, and di/dt the slope of the straight line through the last `window`
seconds by least squares.  The paper gives the three thresholds, and neither window nor baseline
nor what starts the watch: here a detector is deaf until its windows are full, and whoever starts a
motion resets it.

`ContactDetector` is what a robot runs, sample by sample.  The same windows and rules for a whole
log at once serve to try many thresholds on many trials; a test holds one against the other.
"""

import math
from dataclasses import dataclass

import numpy as np

from spirob.errors import ConfigError, DataError
from spirob.parameter import Numbers, bounded

RULES = ("absolute", "relative", "slope")
PAPER = "Alsarraj et al. 2026, active perception"


class ContactSettings(Numbers):
    """Thresholds and windows of a contact detector."""

    owner = "contact"

    absolute: float = bounded(0.8, 0.0, 100.0, "A", "a", "rise above the baseline", PAPER)
    relative: float = bounded(0.5, 0.0, 100.0, "1", "r", "rise over the baseline", PAPER)
    slope: float = bounded(6.0, 0.0, 1e4, "A/s", "g", "slope over the window", PAPER)
    window: float = bounded(0.1, 0.004, 5.0, "s", "T_w", "of the slope; the paper names no length")
    baseline: float = bounded(0.3, 0.004, 30.0, "s", "T_0", "of the baseline, before the window")
    smoothing: float = bounded(0.01, 0.001, 1.0, "s", "T_s", "of the present level")
    confirm: float = bounded(0.005, 0.0, 0.02, "s", "T_c", "a rule has to hold this long")
    least_baseline: float = bounded(
        0.2, 1e-3, 10.0, "A", "i_min", "least base of the relative rule"
    )


@dataclass(frozen=True)
class Contact:
    """A contact as it was declared.

    rule      the first of `RULES` that held;  sample  number of the deciding sample since the reset
    baseline  i_0 [A];  rise  s (i - i_0) [A];  slope  s di/dt [A/s]
    """

    rule: str
    sample: int
    baseline: float
    rise: float
    slope: float


class ContactDetector:
    """Listens to a current; `update` takes constant time, whatever came before.

    period  between samples [s]
    """

    def __init__(self, settings: ContactSettings | None = None, period: float = 1e-3):
        self.settings = s = settings or ContactSettings()
        if not 0.0 < period < s.window / 2:
            raise ConfigError(
                f"contact: a period of {period} s does not fit a window of {s.window}"
            )
        self._window = max(3, round(s.window / period))
        self._baseline = max(1, round(s.baseline / period))
        self._smoothing = min(max(1, round(s.smoothing / period)), self._window)
        self._confirm = max(1, round(s.confirm / period))
        self._length = self._window + self._baseline
        centred = np.arange(self._window) - (self._window - 1) / 2
        self._line = centred / (centred @ centred) / period
        self.reset()

    def reset(self) -> None:
        """Forget everything, as when a new motion starts."""
        # written twice, one length apart, so that the last samples always lie in one piece
        self._seen = np.zeros(2 * self._length)
        self._count = 0
        self._held = dict.fromkeys(RULES, 0)
        self.contact: Contact | None = None

    @property
    def ready(self) -> bool:
        """Whether the windows are full."""
        return self._count >= self._length

    def update(self, current: float) -> Contact | None:
        """Take in one sample [A]; the contact, once there is one, until the next `reset`.

        Raises DataError where the sample is not finite.
        """
        if not math.isfinite(current):
            raise DataError(f"contact: sample {self._count} of the current is {current}")
        place = self._count % self._length
        self._seen[place] = self._seen[place + self._length] = current
        self._count += 1
        if self.contact is None and self.ready:
            self.contact = self._judge(self._seen[place + 1 : place + 1 + self._length])
        return self.contact

    def _judge(self, seen: np.ndarray) -> Contact | None:
        baseline, rise, slope = self._levels(seen)
        s = self.settings
        base = max(abs(baseline), s.least_baseline)
        exceeded = (rise > s.absolute, rise > s.relative * base, slope > s.slope)
        found = None
        for rule, holds in zip(RULES, exceeded, strict=True):
            self._held[rule] = self._held[rule] + 1 if holds else 0
            if found is None and self._held[rule] >= self._confirm:
                found = Contact(rule, self._count - 1, baseline, rise, slope)
        return found

    def _levels(self, seen: np.ndarray) -> tuple[float, float, float]:
        recent = seen[self._baseline :]
        # sums, for a mean by numpy takes three times as long as what it has to do
        baseline = float(np.add.reduce(seen[: self._baseline])) / self._baseline
        side = 1.0 if baseline >= 0.0 else -1.0
        level = float(np.add.reduce(recent[-self._smoothing :])) / self._smoothing
        return baseline, side * (level - baseline), side * float(self._line @ recent)


@dataclass(frozen=True)
class Levels:
    """Baseline i_0 [A], rise s (i - i_0) [A] and slope s di/dt [A/s] at every sample, (T,) each.

    NaN until the windows are full, where no rule holds.
    """

    baseline: np.ndarray
    rise: np.ndarray
    slope: np.ndarray


def levels(values: np.ndarray, settings: ContactSettings, period: float = 1e-3) -> Levels:
    """Levels of a current [A] as a detector that is reset at its first sample sees them."""
    window = max(3, round(settings.window / period))
    before = max(1, round(settings.baseline / period))
    recent = min(max(1, round(settings.smoothing / period)), window)
    out = np.full((3, len(values)), np.nan)
    if len(values) >= window + before:
        ready = slice(window + before - 1, None)
        centred = np.arange(window) - (window - 1) / 2
        line = centred / (centred @ centred) / period
        base = _mean(values, before)[: len(values) - window - before + 1]
        side = np.where(base >= 0.0, 1.0, -1.0)
        level = _mean(values, recent)[window + before - recent :]
        # convolve turns its second argument round
        slope = np.convolve(values, line[::-1], mode="valid")[before:]
        out[:, ready] = base, side * (level - base), side * slope
    return Levels(*out)


def declared(seen: Levels, settings: ContactSettings, period: float = 1e-3) -> int | None:
    """Sample at which the rules declare a contact, or None."""
    confirm = max(1, round(settings.confirm / period))
    base = np.maximum(np.abs(seen.baseline), settings.least_baseline)
    exceeded = {
        "absolute": seen.rise > settings.absolute,
        "relative": seen.rise > settings.relative * base,
        "slope": seen.slope > settings.slope,
    }
    found = [_held(exceeded[rule], confirm) for rule in RULES]
    samples = [k for k in found if k is not None]
    return min(samples) if samples else None


def _mean(values: np.ndarray, width: int) -> np.ndarray:
    return np.convolve(values, np.full(width, 1.0 / width), mode="valid")


def _held(holds: np.ndarray, confirm: int) -> int | None:
    """Last sample of the first run of that many."""
    if len(holds) < confirm:
        return None
    runs = np.convolve(holds, np.ones(confirm), mode="valid") > confirm - 0.5
    return int(np.argmax(runs)) + confirm - 1 if runs.any() else None
