"""The apparent period of a signal that does not come back alike, from several plays of one trial.

    line      the strongest line of the mean power spectrum: Welch's over `SEGMENT`, half of each
              shared with the next, and the mean of all plays' (Bartlett)
    interval  the mean over all plays of the time between peaks that rise by a given height

An arm that is hit at every turn of a wheel comes back irregularly: one play's strongest line is the
highest of many that noise has raised, and its mean over plays is the period of nothing; that of
the mean spectrum is.  How sure a period is tell the plays themselves, drawn again and again with
replacement (bootstrap), for the place of a maximum has no formula.
"""

from collections.abc import Callable, Sequence

import numpy as np
import scipy

from spirob.experiments.compared import Figure
from spirob.experiments.response import PERIOD

SEGMENT = 4.0  # s: lines 0.25 Hz apart
APART = 0.02  # s, least between two peaks
DRAWS = 400


def mean_spectrum(signals: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz], and amplitudes of the lines in the mean spectrum of all plays."""
    frequency, power = spectra(signals)
    return frequency, np.sqrt(2 * power.mean(axis=0))


def spectra(signals: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz], and the power spectrum of each play (plays, frequencies)."""
    values = np.stack(signals)
    n = min(values.shape[1], round(SEGMENT / PERIOD))
    found: tuple[np.ndarray, np.ndarray] = scipy.signal.welch(
        values, 1 / PERIOD, nperseg=n, nfft=8 * n, detrend="linear", scaling="spectrum"
    )
    return found


def line(signals: Sequence[np.ndarray], shortest: float, longest: float) -> tuple[Figure, float]:
    """Period [s] within two bounds, and amplitude, of the strongest line of all plays."""
    frequency, power = spectra(signals)
    band = (frequency >= 1 / longest) & (frequency <= 1 / shortest)
    periods, power = 1 / frequency[band], power[:, band]
    size = float(np.sqrt(2 * power.mean(axis=0).max()))
    return bootstrap(power, lambda each: float(periods[np.argmax(each.mean(axis=0))])), size


def interval(signals: Sequence[np.ndarray], least: float) -> Figure:
    """Mean time [s] between peaks that rise by `least` from their surroundings; NaN without."""
    gaps = []
    for values in signals:
        peaks, _ = scipy.signal.find_peaks(values, prominence=least, distance=round(APART / PERIOD))
        gaps.append((PERIOD * np.ptp(peaks), len(peaks) - 1) if len(peaks) else (0.0, 0))
    return bootstrap(np.array(gaps), _ratio)


def _ratio(each: np.ndarray) -> float:
    whole, count = each.sum(axis=0)
    return float(whole / count) if count else float("nan")


def highest(values: np.ndarray) -> float:
    """By how much the highest peak of a signal rises from its surroundings; 0 without any."""
    _, about = scipy.signal.find_peaks(values, prominence=0.0)
    return float(np.max(about["prominences"], initial=0.0))


def bootstrap(plays: np.ndarray, rule: Callable[[np.ndarray], float]) -> Figure:
    """A rule's figure of all plays (plays, ...), and its deviation over plays drawn of them.

    Of few plays draws differ too little, by √(1 - 1/n), which is given back; of one the error is
    NaN.
    """
    n = len(plays)
    if n < 2:
        return Figure(rule(plays), float("nan"))
    drawn = np.random.default_rng(0).integers(0, n, (DRAWS, n))
    deviation = np.std([rule(plays[each]) for each in drawn])
    return Figure(rule(plays), float(deviation * np.sqrt(n / (n - 1))))
