"""The filters of a log: zero phase, the same for motion, effort and model."""

from functools import cache

import numpy as np
from scipy import signal

BELOW = 0.5  # of the cutoff: edge of the last filter, where the first one passes 99.6 %
PAD = 2.0  # periods of the cutoff by which a signal is continued beyond its ends
ALIAS = 0.4  # of the thinned sample rate: edge of the filter before thinning


def smooth(values: np.ndarray, cutoff: float, period: float) -> np.ndarray:
    """Zero-phase Butterworth filter of 4th order; above half the sample rate it passes all."""
    if cutoff * period >= 0.49:
        return values
    padding = max(30, round(PAD / (cutoff * period)))
    return _both_ways(*_low_pass(cutoff, period), values, padding)


def averaged(values: np.ndarray, count: int) -> np.ndarray:
    """Means of every `count` samples in a row, (n // count,); what is left over is dropped."""
    whole = len(values) // count * count
    return np.asarray(values[:whole].reshape(-1, count).mean(axis=1))


def before_thinning(values: np.ndarray, every: int) -> np.ndarray:
    """The zero-phase filter that goes before keeping every n-th sample, same length."""
    return _both_ways(*_anti_alias(every), values, 60)


def rates(q: np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivative by time, (n,) each."""
    v = derivative(q, period)
    return v, derivative(v, period)


def derivative(values: np.ndarray, period: float) -> np.ndarray:
    """Derivative by central differences of 4th order, same length.

    At an eighth of the sample rate those of 2nd order are 10 % short, these 1 %.
    """
    if len(values) < 5:
        return np.asarray(np.gradient(values, period))
    found = np.empty(len(values))
    found[0], found[-1] = (values[1] - values[0]) / period, (values[-1] - values[-2]) / period
    found[1] = (values[2] - values[0]) / (2.0 * period)
    found[-2] = (values[-1] - values[-3]) / (2.0 * period)
    near, far = values[3:-1] - values[1:-3], values[4:] - values[:-4]
    found[2:-2] = (8.0 * near - far) / (12.0 * period)
    return found


def _both_ways(
    sections: np.ndarray, settled: np.ndarray, values: np.ndarray, padding: int
) -> np.ndarray:
    """`scipy.signal.sosfiltfilt` of values (n,), where the settled state of the filter is known.

    Finding that state takes it longer than to filter a thousand samples.
    """
    more = min(padding, len(values) - 1)
    before, after = values[more:0:-1], values[-2 : -more - 2 : -1]
    padded = np.concatenate([2.0 * values[0] - before, values, 2.0 * values[-1] - after])
    ahead, _ = signal.sosfilt(sections, padded, zi=settled * padded[0])
    back, _ = signal.sosfilt(sections, ahead[::-1], zi=settled * ahead[-1])
    return np.asarray(back[more : len(back) - more][::-1])


@cache
def _low_pass(cutoff: float, period: float) -> tuple[np.ndarray, np.ndarray]:
    return _settled(signal.butter(4, cutoff, fs=1.0 / period, output="sos"))


@cache
def _anti_alias(every: int) -> tuple[np.ndarray, np.ndarray]:
    """That of `scipy.signal.decimate`."""
    return _settled(signal.cheby1(8, 0.05, 2.0 * ALIAS / every, output="sos"))


def _settled(sections: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A filter's sections, and its state after a constant of 1."""
    return sections, signal.sosfilt_zi(sections)
