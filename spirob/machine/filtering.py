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
    padding = min(max(30, round(PAD / (cutoff * period))), len(values) - 1)
    return np.asarray(signal.sosfiltfilt(_low_pass(cutoff, period), values, padlen=padding))


def averaged(values: np.ndarray, count: int) -> np.ndarray:
    """Means of every `count` samples in a row, (n // count,); what is left over is dropped."""
    whole = len(values) // count * count
    return np.asarray(values[:whole].reshape(-1, count).mean(axis=1))


def before_thinning(values: np.ndarray, every: int) -> np.ndarray:
    """The zero-phase filter that goes before keeping every n-th sample, same length."""
    padding = min(60, len(values) - 1)
    return np.asarray(signal.sosfiltfilt(_anti_alias(every), values, padlen=padding))


def rates(q: np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivative by time, (n,) each."""
    v = derivative(q, period)
    return v, derivative(v, period)


def derivative(values: np.ndarray, period: float) -> np.ndarray:
    """Derivative by central differences of 4th order, same length.

    At an eighth of the sample rate those of 2nd order are 10 % short, these 1 %.
    """
    found = np.gradient(values, period)
    if len(values) > 4:
        near, far = values[3:-1] - values[1:-3], values[4:] - values[:-4]
        found[2:-2] = (8.0 * near - far) / (12.0 * period)
    return np.asarray(found)


@cache
def _low_pass(cutoff: float, period: float) -> np.ndarray:
    return np.asarray(signal.butter(4, cutoff, fs=1.0 / period, output="sos"))


@cache
def _anti_alias(every: int) -> np.ndarray:
    return np.asarray(
        signal.cheby1(8, 0.05, 2.0 * ALIAS / every, output="sos")
    )  # scipy.signal.decimate
