"""The current over frequency, in a window that all wraps share.

The window begins with the motion and is long enough for the smallest object; the current's trend,
a straight line, is removed, and what remains is divided by its energy.
"""

import numpy as np
import scipy

from spirob.perceive.temporal import NOMINAL_SPEED
from spirob.perceive.wrap import Wrap, feature

SECONDS = 2.5  # of free motion at the nominal speed


def _spectrum(wrap: Wrap) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz] and shares of energy of the detrended current, without the mean."""
    length = min(int(SECONDS / wrap.period), len(wrap.current))
    level = np.clip(wrap.current[:length], 0.0, wrap.plateau) / wrap.plateau
    window = scipy.signal.windows.hann(length, sym=False)
    power = np.abs(np.fft.rfft(scipy.signal.detrend(level) * window)) ** 2
    power[0] = 0.0
    return np.fft.rfftfreq(length, wrap.period), power / max(power.sum(), 1e-30)


def _band(wrap: Wrap, low: float, high: float) -> float:
    frequency, power = _spectrum(wrap)
    return float(power[(frequency >= low) & (frequency < high)].sum())


@feature("1")
def slow_share(wrap: Wrap) -> float:
    """Share of the current's energy below 0.6 Hz: how long the plateau lasts in the window."""
    return _band(wrap, 0.0, 0.6)


@feature("1")
def middle_share(wrap: Wrap) -> float:
    """Share of the current's energy from 0.6 to 2 Hz: the rise."""
    return _band(wrap, 0.6, 2.0)


@feature("1")
def fast_share(wrap: Wrap) -> float:
    """Share of the current's energy from 2 to 10 Hz: steps of single units meeting the object."""
    return _band(wrap, 2.0, 10.0)


@feature("Hz")
def spectral_centroid(wrap: Wrap) -> float:
    """Mean frequency of the current up to 10 Hz, weighted by energy."""
    frequency, power = _spectrum(wrap)
    low = frequency < 10.0
    return float(frequency[low] @ power[low] / power[low].sum())


@feature("s")
def phase_delay(wrap: Wrap) -> float:
    """Delay of the current's rise after the start, told by the phase of its rate's lowest line."""
    length = min(int(SECONDS / wrap.period), len(wrap.share))
    level = np.clip(wrap.share[:length], 0.0, 1.0)
    level[: wrap.free.start] = 0.0  # the start-up is no rise
    rate = np.diff(level, prepend=0.0)
    # Half a turn over the window, so that every delay within it has a phase of its own.
    turn = np.pi * np.arange(length) / length
    phase = np.angle(rate @ np.exp(1j * turn))
    return float(phase / np.pi * length * wrap.period * wrap.free_speed / NOMINAL_SPEED)
